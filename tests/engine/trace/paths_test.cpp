#include "engine/trace/paths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <vector>

namespace rayloc::paths_test {
namespace {

using ComplexL = std::complex<long double>;

// The definition, in extended precision.
ComplexL direct_sum(const Paths& paths, double frequency_hz) {
  ComplexL h;
  for (const Path& path : paths) {
    const long double angle = -2.0L * std::numbers::pi_v<long double> *
                              static_cast<long double>(frequency_hz) *
                              static_cast<long double>(path.tau);
    h += ComplexL(static_cast<long double>(path.a.re), static_cast<long double>(path.a.im)) *
         std::polar(1.0L, angle);
  }
  return h;
}

TEST(Paths, CfrMatchesSumOverPaths) {
  std::vector<Path> list(3);
  list[0].a = {1e-3, 0.0};
  list[0].tau = 20e-9;
  list[1].a = {-4e-4, 2e-4};
  list[1].tau = 31.7e-9;
  list[2].a = {1e-5, -3e-4};
  list[2].tau = 303.3e-9;
  const Paths paths(list);
  OfdmGrid grid{5.19e9, 312'500.0, {}};
  for (std::int16_t k = -122; k <= 122; ++k) {
    if (std::abs(k) >= 2 && k != 17) {  // a gap at DC and another one
      grid.tone_index.push_back(k);
    }
  }
  const auto h = paths.cfr(grid);
  ASSERT_EQ(h.size(), grid.size());
  for (std::size_t j = 0; j < h.size(); ++j) {
    EXPECT_LE(std::abs(ComplexL(h[j]) - direct_sum(paths, grid.frequency_hz(j))), 2e-15L) << j;
  }
}

TEST(Paths, NoPathGivesZeroChannels) {
  const auto h = Paths().cfr({5.19e9, 312'500.0, {-1, 1}});
  EXPECT_EQ(h, (std::vector<std::complex<double>>{0.0, 0.0}));
}

}  // namespace
}  // namespace rayloc::paths_test
