#include "engine/likelihood/observed_array.h"

namespace rayloc {
namespace {

void put(ObservedArray::Block& block,
         std::size_t coordinate,
         std::size_t entry,
         std::complex<float> value) {
  block.re[coordinate][entry] = value.real();
  block.im[coordinate][entry] = value.imag();
}

}  // namespace

ObservedArray::ObservedArray(std::size_t coordinates) {
  coarse.re.resize(coordinates);
  coarse.im.resize(coordinates);
  windows.fill(coarse);
}

void ObservedArray::set(std::size_t coordinate, std::size_t delay, std::complex<double> value) {
  const std::complex<float> single(value);
  if (delay % kStride == kStride / 2) {
    put(coarse, coordinate, delay / kStride, single);
  }
  for (std::size_t w = 0; w < kWindows; ++w) {
    const std::size_t first = first_of(w);
    if (delay >= first && delay < first + kLaneCount) {
      put(windows[w], coordinate, delay - first, single);
    }
  }
}

std::complex<double> ObservedArray::value(std::size_t coordinate, std::size_t delay) const {
  const std::size_t w = delay / kStride;  // its window holds it
  const std::size_t entry = delay - first_of(w);
  return {static_cast<double>(windows[w].re[coordinate][entry]),
          static_cast<double>(windows[w].im[coordinate][entry])};
}

}  // namespace rayloc
