#include "engine/likelihood/observed_array.h"

namespace rayloc {
namespace {

void put_delay(ObservedArray::Block& block,
               std::size_t coordinate,
               std::size_t entry,
               std::complex<float> value) {
  block.re[coordinate][entry] = value.real();
  block.im[coordinate][entry] = value.imag();
}

// Margin for peaks of the coarse search that may be the best of the fine one: it misses a delay by
// 3 ns at most, which costs about 10.
constexpr float kCoarseMiss = 10.0F;

}  // namespace

ObservedArray::ObservedArray(std::size_t coordinates) {
  coarse.re.resize(coordinates);
  coarse.im.resize(coordinates);
  windows.fill(coarse);
}

std::uint8_t ObservedArray::peak_windows(const Row& values) {
  const float least = *std::max_element(values.begin(), values.end()) - kCoarseMiss;
  unsigned windows = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool is_peak = (i == 0 || values[i] >= values[i - 1]) &&
                         (i + 1 == values.size() || values[i] >= values[i + 1]);
    windows |= is_peak && values[i] >= least ? 1U << i : 0U;
  }
  return static_cast<std::uint8_t>(windows);
}

void ObservedArray::set(std::size_t coordinate, std::size_t delay, std::complex<double> value) {
  const std::complex<float> single(value);
  if (delay % kStride == kStride / 2) {
    put_delay(coarse, coordinate, delay / kStride, single);
  }
  for (std::size_t w = 0; w < kWindows; ++w) {
    const std::size_t first = first_of(w);
    if (delay >= first && delay < first + kLaneCount) {
      put_delay(windows[w], coordinate, delay - first, single);
    }
  }
}

void ObservedArray::set(std::size_t coordinate,
                        std::span<const float, kDelays> re,
                        std::span<const float, kDelays> im) {
  for (std::size_t w = 0; w < kWindows; ++w) {
    const std::size_t at = kStride * w + kStride / 2;
    coarse.re[coordinate][w] = re[at];
    coarse.im[coordinate][w] = im[at];
    std::copy_n(re.data() + first_of(w), kLaneCount, windows[w].re[coordinate].begin());
    std::copy_n(im.data() + first_of(w), kLaneCount, windows[w].im[coordinate].begin());
  }
}

std::complex<double> ObservedArray::value(std::size_t coordinate, std::size_t delay) const {
  const std::size_t w = delay / kStride;  // index of the window that contains it
  const std::size_t entry = delay - first_of(w);
  return {static_cast<double>(windows[w].re[coordinate][entry]),
          static_cast<double>(windows[w].im[coordinate][entry])};
}

}  // namespace rayloc
