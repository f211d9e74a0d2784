#include "engine/likelihood/box/delay_rows.h"

#include <algorithm>
#include <complex>

#include "engine/base/check.h"

namespace rayloc {

DelayRows delay_rows(const ObservedArray& observed, std::size_t values) {
  DelayRows rows;
  rows.re.resize(observed.coordinates());
  rows.im.resize(observed.coordinates());
  for (std::size_t i = 0; i < observed.coordinates(); ++i) {
    for (std::size_t t = 0; t < ObservedArray::kDelays; ++t) {
      const std::complex<float> value(observed.value(i, t));
      rows.re[i][t] = value.real();
      rows.im[i][t] = value.imag();
    }
  }
  rows.noise =
      static_cast<float>(noise_outside_basis(observed.captured, observed.coordinates(), values));
  return rows;
}

double noise_outside_basis(double captured, std::size_t coordinates, std::size_t values) {
  RAYLOC_CHECK(values > coordinates);
  const auto inside = static_cast<double>(coordinates);
  const auto outside = static_cast<double>(values - coordinates);
  return std::clamp((1.0 - captured) * inside / outside, 0.0, 1.0);
}

}  // namespace rayloc
