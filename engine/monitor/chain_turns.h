// Turns of receive chains against each other, from what each of them heard of known spots.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace rayloc {

// Sums over spots of the chains' phasors, each against each. A spot's common phase cancels.
class ChainTurns {
 public:
  explicit ChainTurns(std::size_t chains);

  // `phasor`: of each chain, how it is turned and how much that counts (complex, any unit).
  void add(std::span<const std::complex<double>> phasor);

  // Of each chain against the chain that most others agree with [rad].
  std::vector<double> turns() const;

 private:
  std::vector<std::vector<std::complex<double>>> relative_;  // [reference][chain]
};

// Variance of the turn of a chain against another [rad^2] at one spot of which the room explains
// `share` of the power once the chains are turned to fit. Paths that differ by less than the
// bandwidth resolves turn all tones of a chain alike, so its tones count as one sample; of the six
// numbers of three chains the fit takes four, which halves what it leaves and is undone here.
double turn_variance(double share);

}  // namespace rayloc
