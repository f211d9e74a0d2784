// DelaySpread: the power-weighted spread of the delays of an antenna's paths; the only delay
// observable of the paper's localization, as every frame has a random timing offset (METHODS C3).
//
// With c the normalised correlation of tones that are D = 5 MHz apart (less in a narrow band),
//   c = sum h_b conj(h_a) / sqrt(sum |h_a|^2 sum |h_b|^2),    spread = sqrt(1 - |c|^2 + floor)
//                                                                      / (2 pi D),
// which is the standard deviation of the power delay profile while that is short against 1 / D: a
// timing offset rotates c and leaves |c| unchanged. It saturates at 32 ns. The floor keeps the
// slope of the root finite for a single path; measured and expected channels are treated alike.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "engine/channel/ofdm_grid.h"

namespace rayloc::paper {

class DelaySpread {
 public:
  // REQUIRES: grid.size() >= 2, floor > 0.
  DelaySpread(const OfdmGrid& grid, double floor);

  // [s] for each antenna; 0 for one without a signal. REQUIRES: h is [antenna][tone].
  std::vector<double> of(std::span<const std::complex<double>> h) const;

  // From dL / d(spread) [1/s], g with dL = Re sum conj(g) dh.
  std::vector<std::complex<double>> adjoint(std::span<const std::complex<double>> h,
                                            std::span<const double> spread_adjoint) const;

 private:
  struct Correlation {
    std::complex<double> cross;
    double lower_power = 0.0;
    double upper_power = 0.0;
    double square = 0.0;  // |c|^2
    bool is_silent = true;
  };
  Correlation correlate(std::span<const std::complex<double>> row) const;
  double spread(const Correlation& correlation) const;

  std::size_t tones_;
  double floor_;
  double angular_step_ = 0.0;                              // [rad/s], 2 pi D
  std::vector<std::pair<std::size_t, std::size_t>> pair_;  // tones that are D apart
};

}  // namespace rayloc::paper
