// Alignment of arrays [antenna][tone] that are known up to one complex factor and one delay.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/channel/ofdm_grid.h"

namespace rayloc {

struct Alignment {
  double delay = 0.0;           // [s], of `value` relative to `reference`
  std::complex<double> factor;  // reference ~ factor * value * exp(+j 2 pi f delay)
  double correlation = 0.0;     // |<reference, value>|^2 / (|reference|^2 |value|^2), at `delay`
};

// Finds the delay and the factor that fit `value` to `reference` in least squares over all entries.
// The delay is accurate to a hundredth of the resolution of the band: zero-padded transform, then
// Newton steps on the squared correlation.
class Aligner {
 public:
  explicit Aligner(const OfdmGrid& grid);

  // REQUIRES: sizes equal and a multiple of grid.size().
  Alignment align(std::span<const std::complex<double>> reference,
                  std::span<const std::complex<double>> value) const;

  // value[k] *= factor exp(+j 2 pi f_k delay)
  void apply(const Alignment& alignment, std::span<std::complex<double>> value) const;

 private:
  double coarse_delay(std::span<const std::complex<double>> cross) const;

  std::vector<double> angular_offset_;  // [rad/s], 2 pi f_k from the middle tone
  std::vector<int> bin_;                // of each tone in the transform
  std::vector<std::complex<double>> twiddle_;
  double bin_delay_ = 0.0;  // [s]
};

}  // namespace rayloc
