// Ratios of adjacent receive antennas, h_m / h_{m+1} on every tone: invariant to a frame's unknown
// gain, phase and timing offset, since all chains share them (METHODS A2, C9).
//
// Where the denominator fades, a ratio has no information and no bound. It is therefore computed as
//
//   r = h_m conj(h_{m+1}) / (|h_{m+1}|^2 + floor P_{m+1}),
//
// with P the mean square over the antenna's tones: the ratio itself where the denominator is
// strong, at most 0.5 |h_m| / sqrt(floor P) near a null, and 0 for an antenna without a signal.
// Measured and expected channels are treated alike, so a comparison is not biased by it.
//
// Arrays are [antenna][tone], tones fastest; removing chain gains is left to the caller.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/channel/ofdm_grid.h"
#include "engine/observe/savitzky_golay.h"

namespace rayloc {

// About the share of noise and distortion in a frame of a real receiver, -30 dB.
inline constexpr double kRatioFloor = 1e-3;

// [antenna - 1][tone]. REQUIRES: h.size() a multiple of `tones` > 0, floor > 0; adjoint likewise.
std::vector<std::complex<double>> csi_ratio(std::span<const std::complex<double>> h,
                                            std::size_t tones,
                                            double floor = kRatioFloor);

// From g with dL = Re sum conj(g) dr, the same for h: dL = Re sum conj(result) dh.
std::vector<std::complex<double>> csi_ratio_adjoint(
    std::span<const std::complex<double>> h,
    std::size_t tones,
    double floor,
    std::span<const std::complex<double>> ratio_adjoint);

// The amplitude of the ratio after smoothing along the tones.
// Thread safety: const members may be used from many threads.
class RatioAmplitude {
 public:
  // REQUIRES: valid options, floor > 0, at least one tone.
  explicit RatioAmplitude(const OfdmGrid& grid,
                          const SavitzkyGolayOptions& smoothing = {},
                          double floor = kRatioFloor);

  // [antenna - 1][tone]. REQUIRES: h.size() a multiple of grid.size().
  std::vector<double> of(std::span<const std::complex<double>> h) const;

  // From dL / d(amplitude), g with dL = Re sum conj(g) dh. Where the amplitude is exactly 0 it has
  // no derivative; 0 is used.
  std::vector<std::complex<double>> adjoint(std::span<const std::complex<double>> h,
                                            std::span<const double> amplitude_adjoint) const;

 private:
  std::vector<std::complex<double>> smoothed(std::span<const std::complex<double>> h) const;

  SavitzkyGolay smoother_;
  double floor_;
};

}  // namespace rayloc
