#include "engine/paper/delay_spread.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>

namespace rayloc::paper::delay_spread_test {
namespace {

using Value = std::complex<double>;

struct TestPath {
  Value a;
  double delay;  // [s]
};

OfdmGrid make_grid() {
  OfdmGrid grid{5.19e9, 312'500.0, {}};
  for (int k = -58; k <= 58; ++k) {
    if (std::abs(k) > 1) {
      grid.tone_index.push_back(static_cast<std::int16_t>(k));
    }
  }
  return grid;
}

// 160 MHz without a gap: where D = 5 MHz is 16 tones, 496 pairs are that far apart.
OfdmGrid wide_grid(int step) {
  OfdmGrid grid{5.19e9, 312'500.0, {}};
  for (int k = -256; k < 256; k += step) {
    grid.tone_index.push_back(static_cast<std::int16_t>(k));
  }
  return grid;
}
// Two turns over these pairs, so that the cross terms of two echoes vanish.
constexpr double kTwoTurns = 2.0 / (496.0 * 312'500.0);  // [s], 13 ns

std::vector<Value> channel(const std::vector<TestPath>& paths, const OfdmGrid& grid = make_grid()) {
  std::vector<Value> h(grid.size());
  for (std::size_t k = 0; k < grid.size(); ++k) {
    for (const TestPath& path : paths) {
      h[k] += path.a * std::polar(1.0, -2.0 * std::numbers::pi * grid.offset_hz(k) * path.delay);
    }
  }
  return h;
}

TEST(DelaySpread, IsTheStandardDeviationOfThePowerDelayProfile) {
  // Powers 4 : 1, so sqrt(0.8 * 0.2) of their distance; every tone, and every fourth.
  for (const int step : {1, 4}) {
    const OfdmGrid grid = wide_grid(step);
    const DelaySpread spread(grid, 1e-9);
    const auto found = spread.of(channel({{2.0, 0.0}, {{0.0, 1.0}, kTwoTurns}}, grid));
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0], 0.4 * kTwoTurns, 0.01 * 0.4 * kTwoTurns) << step;
  }
}

TEST(DelaySpread, GrowsWithTheDistanceOfTheEchoes) {
  const DelaySpread spread(make_grid(), 1e-3);
  double last = 0.0;
  for (const double delay : {0.0, 5e-9, 15e-9, 30e-9, 50e-9}) {
    const double found = spread.of(channel({{1.0, 0.0}, {0.5, delay}}))[0];
    EXPECT_GT(found, last);
    last = found;
  }
}

TEST(DelaySpread, ForgetsGainPhaseAndTimingOffset) {
  const DelaySpread spread(make_grid(), 1e-3);
  const auto near = spread.of(channel({{1.0, 0.0}, {0.4, 20e-9}}));
  const auto late = spread.of(channel({{{0.0, 0.3}, 310e-9}, {{0.0, 0.12}, 330e-9}}));
  EXPECT_NEAR(late[0], near[0], 1e-18);
}

TEST(DelaySpread, IsZeroForZeroChannels) {
  const DelaySpread spread(make_grid(), 1e-3);
  const std::vector<Value> silence(make_grid().size());
  EXPECT_EQ(spread.of(silence)[0], 0.0);
  for (const Value& value : spread.adjoint(silence, std::vector{1.0})) {
    EXPECT_EQ(value, Value());
  }
}

TEST(DelaySpread, AdjointMatchesDifferences) {
  const DelaySpread spread(make_grid(), 1e-3);
  const std::size_t tones = make_grid().size();
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  auto h = channel({{1.0, 0.0}, {0.5, 15e-9}});
  const auto second = channel({{0.7, 1e-9}, {0.6, 35e-9}});
  h.insert(h.end(), second.begin(), second.end());
  const std::vector<double> weight = {0.3e9, -0.8e9};  // of the sum that is differentiated
  const auto sum = [&](const std::vector<Value>& at) {
    const auto found = spread.of(at);
    return weight[0] * found[0] + weight[1] * found[1];
  };
  const auto adjoint = spread.adjoint(h, weight);
  ASSERT_EQ(adjoint.size(), 2 * tones);
  for (int direction = 0; direction < 5; ++direction) {
    constexpr double kStep = 1e-6;
    double exact = 0.0;
    auto above = h;
    auto below = h;
    for (std::size_t i = 0; i < h.size(); ++i) {
      const Value along(normal(random), normal(random));
      exact += (std::conj(adjoint[i]) * along).real();
      above[i] += kStep * along;
      below[i] -= kStep * along;
    }
    EXPECT_NEAR(exact, (sum(above) - sum(below)) / (2.0 * kStep), 1e-6 * std::abs(exact));
  }
}

}  // namespace
}  // namespace rayloc::paper::delay_spread_test
