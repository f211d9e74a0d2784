#include "engine/likelihood/box/moment_projection.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "engine/likelihood/observation_model.h"

namespace rayloc::moment_projection_test {
namespace {

using Value = std::complex<double>;

// Without the tones about the carrier, and without every `missing`-th of the others.
OfdmGrid grid_of(int last, int missing = 0) {
  OfdmGrid grid{5.19e9, 312'500.0, {}};
  for (int k = -last; k <= last; ++k) {
    if (std::abs(k) > 1 && (missing == 0 || k % missing != 0)) {
      grid.tone_index.push_back(static_cast<std::int16_t>(k));
    }
  }
  return grid;
}

// Six echoes at each antenna, a common delay, and noise.
std::vector<Value> channel(const OfdmGrid& grid, std::size_t antennas, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Value> h;
  for (std::size_t m = 0; m < antennas; ++m) {
    std::vector<Value> row(grid.size());
    for (int echo = 0; echo < 6; ++echo) {
      const Value a = std::exp(-0.7 * echo) * Value(normal(random), normal(random));
      const double delay = 2e-7 + 6e-9 * echo;
      for (std::size_t k = 0; k < grid.size(); ++k) {
        row[k] += a * std::polar(1.0, -2.0 * std::numbers::pi * grid.offset_hz(k) * delay);
      }
    }
    for (const Value& v : row) {
      h.push_back(v + 0.01 * Value(normal(random), normal(random)));
    }
  }
  return h;
}

// Rounding of a unit array: each step of a rotation and each term of a sum rounds once.
double rounding(const OfdmGrid& grid) {
  return static_cast<double>(std::numeric_limits<float>::epsilon()) *
         static_cast<double>(ObservedArray::kDelays + grid.size());
}

void expect_near(const ObservedArray& one, const ObservedArray& other, double tolerance) {
  ASSERT_EQ(one.coordinates(), other.coordinates());
  for (std::size_t i = 0; i < one.coordinates(); ++i) {
    for (std::size_t t = 0; t < ObservedArray::kDelays; ++t) {
      EXPECT_LT(std::abs(one.value(i, t) - other.value(i, t)), tolerance) << i << " " << t;
    }
    for (std::size_t w = 0; w < ObservedArray::kWindows; ++w) {
      EXPECT_NEAR(one.coarse.re[i][w], other.coarse.re[i][w], tolerance) << i << " " << w;
      EXPECT_NEAR(one.coarse.im[i][w], other.coarse.im[i][w], tolerance) << i << " " << w;
    }
  }
  EXPECT_NEAR(one.captured, other.captured, 2.0 * tolerance);
}

TEST(MomentProjection, IsTheObservationInDoublePrecision) {
  for (const OfdmGrid& grid : {grid_of(28), grid_of(58), grid_of(122), grid_of(58, 7)}) {
    for (const std::size_t antennas : {1U, 2U, 3U, 4U}) {
      SCOPED_TRACE(std::to_string(grid.size()) + " tones, " + std::to_string(antennas));
      const ObservationModel model(grid, antennas);
      const MomentProjection projection(grid, model.basis(), antennas);
      const std::vector<Value> h = channel(grid, antennas, 7);
      expect_near(projection.observe(h), model.observe(h), rounding(grid));
    }
  }
}

TEST(MomentProjection, AcceptsSilentChains) {
  const OfdmGrid grid = grid_of(58);
  const ObservationModel model(grid, 3);
  const MomentProjection projection(grid, model.basis(), 3);
  std::vector<Value> h = channel(grid, 3, 3);
  std::fill_n(h.begin() + static_cast<std::ptrdiff_t>(grid.size()), grid.size(), Value());
  expect_near(projection.observe(h), model.observe(h), rounding(grid));
  std::fill(h.begin(), h.end(), Value());
  expect_near(projection.observe(h), model.observe(h), 1e-30);
}

class MomentProjectionTargets : public ::testing::Test {
 protected:
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_F(MomentProjectionTargets, EveryKindOfProcessor) {
  const OfdmGrid grid = grid_of(58);
  const ObservationModel model(grid, 3);
  const MomentProjection projection(grid, model.basis(), 3);
  const std::vector<Value> h = channel(grid, 3, 5);
  const ObservedArray expected = model.observe(h);
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  ASSERT_GE(targets.size(), 2U);
  for (const std::int64_t target : targets) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    expect_near(projection.observe(h), expected, rounding(grid));
  }
}

}  // namespace
}  // namespace rayloc::moment_projection_test
