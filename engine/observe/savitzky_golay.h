// SavitzkyGolay: smoothing along the tones by local polynomials, in least squares [SG].
//
// Every value is replaced by that of the polynomial through the `window` values around it; near the
// ends of the band the outermost window is used. On tones without a gap this is
// scipy.signal.savgol_filter with mode "interp". Unsent tones (those around DC) are neither
// interpolated nor treated as a band edge: `window` counts the existing tones, and the polynomial
// uses the true tone numbers, so a window across the gap is wider than others.
//
// Thread safety: const members may be used from many threads.
// References: [SG] A. Savitzky, M. J. E. Golay, Anal. Chem. 36 (1964) 1627.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/base/expected.h"

namespace rayloc {

struct SavitzkyGolayOptions {
  int window = 11;  // values, odd
  int order = 3;    // of the polynomial, < window
};

// An Error when a window or an order is invalid.
Expected<void> validate(const SavitzkyGolayOptions& options);

class SavitzkyGolay {
 public:
  // `position`: ascending, in any unit. With fewer values than a window all of them are the window,
  // and the order is at most one less than their number. REQUIRES: valid options, a position.
  SavitzkyGolay(std::span<const double> position, const SavitzkyGolayOptions& options);

  std::size_t size() const { return first_.size(); }

  // REQUIRES: values.size() == size(). The same holds for adjoint().
  std::vector<std::complex<double>> smooth(std::span<const std::complex<double>> values) const;

  // The transpose: propagates dL / d(smoothed) back to dL / d(values).
  std::vector<std::complex<double>> adjoint(
      std::span<const std::complex<double>> smoothed_adjoint) const;

 private:
  std::size_t window_ = 0;
  std::vector<std::size_t> first_;   // index of the first value of each window
  std::vector<double> coefficient_;  // [value][place in its window]
};

}  // namespace rayloc
