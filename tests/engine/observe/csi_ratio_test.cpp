#include "engine/observe/csi_ratio.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace rayloc::csi_ratio_test {
namespace {

using Value = std::complex<double>;

OfdmGrid make_grid() {
  OfdmGrid grid{5.19e9, 312'500.0, {}};
  for (int k = -58; k <= 58; ++k) {
    if (std::abs(k) > 1) {
      grid.tone_index.push_back(static_cast<std::int16_t>(k));
    }
  }
  return grid;
}

// Three antennas, a few random paths each.
std::vector<Value> channel(const OfdmGrid& grid, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<Value> h(3 * grid.size());
  for (std::size_t antenna = 0; antenna < 3; ++antenna) {
    for (int path = 0; path < 6; ++path) {
      const Value a(normal(random), normal(random));
      const double delay = 40e-9 * uniform(random);
      for (std::size_t k = 0; k < grid.size(); ++k) {
        h[antenna * grid.size() + k] +=
            a * std::polar(1.0, -2.0 * std::numbers::pi * grid.offset_hz(k) * delay);
      }
    }
  }
  return h;
}

// dL along `direction` by the adjoint and by central differences.
void expect_derivative(const std::vector<Value>& h,
                       const std::function<double(const std::vector<Value>&)>& loss,
                       const std::vector<Value>& adjoint) {
  const auto direction = channel(make_grid(), 99);
  double exact = 0.0;
  auto above = h;
  auto below = h;
  constexpr double kStep = 1e-6;
  for (std::size_t i = 0; i < h.size(); ++i) {
    exact += (std::conj(adjoint[i]) * direction[i]).real();
    above[i] += kStep * direction[i];
    below[i] -= kStep * direction[i];
  }
  const double numeric = (loss(above) - loss(below)) / (2.0 * kStep);
  ASSERT_GT(std::abs(numeric), 1e-3);
  EXPECT_NEAR(exact, numeric, 1e-6 * std::abs(numeric));
}

TEST(CsiRatio, IsTheRatioWhereTheDenominatorIsStrong) {
  const std::vector<Value> h = {{1.0, 2.0}, {3.0, -1.0}, {0.5, 0.5}, {-1.0, 2.0}};
  const auto ratio = csi_ratio(h, 2, 1e-12);
  ASSERT_EQ(ratio.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(std::abs(ratio[k] - h[k] / h[2 + k]), 0.0, 1e-10);
  }
}

TEST(CsiRatio, ForgetsGainPhaseAndTimingOffset) {
  const OfdmGrid grid = make_grid();
  const auto h = channel(grid, 1);
  auto received = h;
  for (std::size_t i = 0; i < h.size(); ++i) {
    const double turn = 2.0 * std::numbers::pi * grid.offset_hz(i % grid.size()) * 230e-9;
    received[i] *= std::polar(7.3, 1.1 - turn);
  }
  const auto expected = csi_ratio(h, grid.size());
  const auto ratio = csi_ratio(received, grid.size());
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    EXPECT_NEAR(std::abs(ratio[i] - expected[i]), 0.0, 1e-12 * (1.0 + std::abs(expected[i])));
  }
}

TEST(CsiRatio, StaysBoundedAtANull) {
  constexpr double kFloor = 1e-3;
  for (const double null : {0.0, 1e-12, 1e-3, 0.05, 0.2}) {
    const std::vector<Value> h = {1.0, 1.0, 1.0, null};
    const double mean = 0.5 * (1.0 + null * null);
    const double bound = 0.5 / std::sqrt(kFloor * mean);
    EXPECT_LE(std::abs(csi_ratio(h, 2, kFloor)[1]), bound * (1.0 + 1e-12)) << null;
  }
  // An antenna that receives nothing.
  EXPECT_EQ(csi_ratio(std::vector<Value>{1.0, 0.0}, 1)[0], Value());
}

TEST(CsiRatio, AdjointMatchesDifferences) {
  const OfdmGrid grid = make_grid();
  auto h = channel(grid, 3);
  h[grid.size() + 20] *= 1e-3;  // a null of a denominator
  const auto weight = channel(grid, 4);
  const auto loss = [&](const std::vector<Value>& at) {
    double sum = 0.0;
    const auto ratio = csi_ratio(at, grid.size());
    for (std::size_t i = 0; i < ratio.size(); ++i) {
      sum += (std::conj(weight[i]) * ratio[i]).real();
    }
    return sum;
  };
  const std::span by_ratio(weight.data(), 2 * grid.size());
  expect_derivative(h, loss, csi_ratio_adjoint(h, grid.size(), kRatioFloor, by_ratio));
}

TEST(RatioAmplitude, AdjointMatchesDifferences) {
  const OfdmGrid grid = make_grid();
  const RatioAmplitude amplitude(grid, {9, 2});
  const auto h = channel(grid, 5);
  const auto weight = channel(grid, 6);
  std::vector<double> by_amplitude;
  for (std::size_t i = 0; i < 2 * grid.size(); ++i) {
    by_amplitude.push_back(weight[i].real());
  }
  const auto loss = [&](const std::vector<Value>& at) {
    const auto a = amplitude.of(at);
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      sum += by_amplitude[i] * a[i];
    }
    return sum;
  };
  expect_derivative(h, loss, amplitude.adjoint(h, by_amplitude));
}

TEST(RatioAmplitude, WithoutSmoothingIsTheAmplitudeOfTheRatio) {
  const OfdmGrid grid = make_grid();
  const auto h = channel(grid, 7);
  const auto ratio = csi_ratio(h, grid.size());
  const auto amplitude = RatioAmplitude(grid, {1, 0}).of(h);
  ASSERT_EQ(amplitude.size(), ratio.size());
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    EXPECT_NEAR(amplitude[i], std::abs(ratio[i]), 1e-12 * (1.0 + amplitude[i]));
  }
}

TEST(RatioAmplitude, IsZeroWithoutSlopeForZeroChannels) {
  const OfdmGrid grid = make_grid();
  const RatioAmplitude amplitude(grid);
  const std::vector<Value> silence(3 * grid.size());
  for (const double a : amplitude.of(silence)) {
    EXPECT_EQ(a, 0.0);
  }
  for (const Value& g : amplitude.adjoint(silence, std::vector<double>(2 * grid.size(), 1.0))) {
    EXPECT_EQ(g, Value());
  }
}

}  // namespace
}  // namespace rayloc::csi_ratio_test
