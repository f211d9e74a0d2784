// Phase offsets between receive chains, from their observations of reference points.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace rayloc {

// Sums over points of the chains' phasors, for every pair of chains. A point's common phase
// cancels.
class ChainTurns {
 public:
  explicit ChainTurns(std::size_t chains);

  // `phasor`: for each chain its phase and, as magnitude, its weight (complex, any unit).
  void add(std::span<const std::complex<double>> phasor);

  // Phase offset of each chain from the chain that most others agree with [rad].
  std::vector<double> turns() const;

 private:
  std::vector<std::vector<std::complex<double>>> relative_;  // [reference][chain]
};

// Variance of the phase offset between two chains [rad^2] at one point where the room explains
// `share` of the power after the chains are rotated to fit. Paths that differ by less than the
// bandwidth resolves rotate all tones of a chain alike, so its tones count as one sample; of the
// six numbers of three chains the fit uses four, which halves the remainder and is corrected here.
double turn_variance(double share);

}  // namespace rayloc
