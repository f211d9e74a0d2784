#include "engine/trace/paths.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/check.h"

namespace rayloc {
namespace {

// Between neighbouring tones the phase is turned by a constant factor; after so many steps it is
// computed afresh, which keeps the error near one rounding per step.
constexpr std::size_t kTonesPerAnchor = 32;

// exp(-j 2 pi f tau). The whole turns are taken off first: f tau is about 100.
Complex<double> phasor(double turns) {
  const double angle = -2.0 * std::numbers::pi * (turns - std::round(turns));
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

std::vector<std::complex<double>> Paths::cfr(const OfdmGrid& grid) const {
  std::vector<std::complex<double>> h(grid.size());
  cfr(grid, h);
  return h;
}

void Paths::cfr(const OfdmGrid& grid, std::span<std::complex<double>> out) const {
  RAYLOC_CHECK(out.size() == grid.size());
  std::fill(out.begin(), out.end(), std::complex<double>{});
  for (const Path& path : paths_) {
    const Complex<double> step = phasor(grid.spacing_hz * path.tau);
    Complex<double> value;
    std::size_t since_anchor = kTonesPerAnchor;
    for (std::size_t j = 0; j < out.size(); ++j) {
      const bool next_tone = j > 0 && grid.tone_index[j] == grid.tone_index[j - 1] + 1;
      if (!next_tone || since_anchor == kTonesPerAnchor) {
        value = path.a * phasor(grid.frequency_hz(j) * path.tau);
        since_anchor = 0;
      } else {
        value = value * step;
      }
      ++since_anchor;
      out[j] += std::complex<double>(value.re, value.im);
    }
  }
}

}  // namespace rayloc
