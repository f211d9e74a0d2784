// Loss: the two losses of the paper's calibration at one point (METHODS A3): L_p of the
// delays, for positions of objects, and L_m of the amplitudes of antenna ratios, for materials.
//
// Both are symmetric mean absolute percentage errors with absolute values in the denominator
// (METHODS C5), as shares: 0 when measured and expected agree, 2 at most.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/channel/ofdm_grid.h"
#include "engine/observe/alignment.h"
#include "engine/observe/csi_ratio.h"
#include "engine/paper/delay.h"

namespace rayloc::paper {

// Mean of 2 |a - b| / (|a| + |b|); a term with both 0 is 0. REQUIRES: equal sizes, not 0.
double smape(std::span<const double> measured, std::span<const double> expected);

// d smape / d expected. The slope at a corner of a term (a = b, b = 0) is 0.
std::vector<double> smape_gradient(std::span<const double> measured,
                                   std::span<const double> expected);

enum class LossKind : std::uint8_t { kDelay, kRatioAmplitude };

class Loss {
 public:
  // REQUIRES: as for Delay and RatioAmplitude.
  Loss(const OfdmGrid& grid, const SavitzkyGolayOptions& smoothing, double floor);

  // Observables of a burst at a point.
  struct Measured {
    Delay::Anchor anchor;
    std::vector<double> delay;      // [s], [antenna][pair of tones]
    std::vector<double> amplitude;  // [antenna - 1][tone]
  };
  // `h`: [antenna][tone], chain gains removed, with any timing offset; `line_of_sight` [s] from the
  // device to each antenna.
  Measured measure(std::span<const std::complex<double>> h,
                   std::vector<double> line_of_sight) const;

  // `expected`: [antenna][tone]. An all-zero channel has the maximum loss: 2.
  double value(LossKind kind,
               const Measured& measured,
               std::span<const std::complex<double>> expected) const;

  // g with d value = Re sum conj(g) d expected.
  std::vector<std::complex<double>> adjoint(LossKind kind,
                                            const Measured& measured,
                                            std::span<const std::complex<double>> expected) const;

 private:
  OfdmGrid grid_;
  Delay delay_;
  RatioAmplitude amplitude_;
  Aligner aligner_;
};

}  // namespace rayloc::paper
