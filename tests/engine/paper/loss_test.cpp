#include "engine/paper/loss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace rayloc::paper::loss_test {
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

Value response(const std::vector<TestPath>& paths, double frequency, int power_of_delay = 0) {
  Value h;
  for (const TestPath& path : paths) {
    h += path.a * std::pow(path.delay, power_of_delay) *
         std::polar(1.0, -2.0 * std::numbers::pi * std::fmod(frequency * path.delay, 1.0));
  }
  return h;
}

// Line of sight and two reflections of each of three antennas.
std::vector<std::vector<TestPath>> antennas(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::vector<std::vector<TestPath>> result;
  for (int antenna = 0; antenna < 3; ++antenna) {
    std::vector<TestPath> paths = {{1.0, 8e-9 + 0.3e-9 * antenna}};
    for (int i = 0; i < 2; ++i) {
      paths.push_back({std::polar(0.4 * uniform(random), 6.0 * uniform(random)),
                       (12.0 + 20.0 * uniform(random)) * 1e-9});
    }
    result.push_back(paths);
  }
  return result;
}

std::vector<Value> channel(const std::vector<std::vector<TestPath>>& antennas) {
  const OfdmGrid grid = make_grid();
  std::vector<Value> h;
  for (const auto& paths : antennas) {
    for (std::size_t k = 0; k < grid.size(); ++k) {
      h.push_back(response(paths, grid.frequency_hz(k)));
    }
  }
  return h;
}

const std::vector<double> kLineOfSight = {8e-9, 8.3e-9, 8.6e-9};

// As a frame brings it: gain, phase and timing offset unknown.
std::vector<Value> as_received(std::vector<Value> h) {
  const OfdmGrid grid = make_grid();
  for (std::size_t i = 0; i < h.size(); ++i) {
    const double turn = 2.0 * std::numbers::pi * grid.offset_hz(i % grid.size()) * 310e-9;
    h[i] *= std::polar(0.3, 2.0 - turn);
  }
  return h;
}

TEST(Smape, IsTheMeanOfAbsoluteShares) {
  // 2 |1 - 3| / 4 = 1; equal; opposite signs: 2; both 0: 0.
  EXPECT_DOUBLE_EQ(smape(std::vector{1.0, -2.0, 1.0, 0.0}, std::vector{3.0, -2.0, -5.0, 0.0}),
                   0.75);
}

TEST(Smape, GradientMatchesDifferences) {
  const std::vector<double> measured = {1.0, -2.0, 1.0, 0.5};
  const std::vector<double> expected = {3.0, -1.5, -5.0, 0.1};
  const auto gradient = smape_gradient(measured, expected);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    constexpr double kStep = 1e-6;
    auto above = expected;
    auto below = expected;
    above[i] += kStep;
    below[i] -= kStep;
    EXPECT_NEAR(
        gradient[i], (smape(measured, above) - smape(measured, below)) / (2.0 * kStep), 1e-9);
  }
  EXPECT_EQ(smape_gradient(std::vector{2.0}, std::vector{2.0})[0], 0.0);
  EXPECT_EQ(smape_gradient(std::vector{0.0}, std::vector{0.0})[0], 0.0);
}

TEST(PaperDelay, IsExactForALineOfSight) {
  const std::vector<std::vector<TestPath>> direct = {
      {{1.0, 8e-9}}, {{1.0, 8.3e-9}}, {{1.0, 8.6e-9}}};
  const Loss loss(make_grid(), {}, 1e-3);
  const auto measured = loss.measure(as_received(channel(direct)), kLineOfSight);
  for (std::size_t i = 0; i < measured.delay.size(); ++i) {
    EXPECT_NEAR(measured.delay[i], kLineOfSight[i / 112], 1e-15);  // 112 pairs of neighbours
  }
}

TEST(PaperDelay, IsTheGroupDelayButForItsMean) {
  const auto paths = antennas(1);
  const OfdmGrid grid = make_grid();
  const auto h = channel(paths);
  const Delay delay(grid, {1, 0}, 1e-9);
  const auto anchor = delay.anchor(h, kLineOfSight);
  const auto found = delay.of(h, anchor);
  // In closed form, -d arg(h) / d(2 pi f) = Re(sum a tau exp(..) / h), between the two tones.
  std::vector<double> exact;
  double mean_found = 0.0;
  double mean_exact = 0.0;
  for (const auto& of_antenna : paths) {
    for (std::size_t k = 0; k + 1 < grid.size(); ++k) {
      if (grid.tone_index[k + 1] == grid.tone_index[k] + 1) {
        const double f = grid.frequency_hz(k) + 0.5 * grid.spacing_hz;
        exact.push_back((response(of_antenna, f, 1) / response(of_antenna, f)).real());
        mean_exact += exact.back();
      }
    }
  }
  ASSERT_EQ(found.size(), exact.size());
  for (const double value : found) {
    mean_found += value;
  }
  const double shift = (mean_found - mean_exact) / static_cast<double>(exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_NEAR(found[i] - shift, exact[i], 5e-12) << i;  // of up to 10 ns; a tone's step is finite
  }
}

TEST(PaperLoss, ForgetsGainPhaseAndTimingOffset) {
  const Loss loss(make_grid(), {}, 1e-3);
  const auto h = channel(antennas(2));
  const auto measured = loss.measure(as_received(h), kLineOfSight);
  EXPECT_NEAR(loss.value(LossKind::kRatioAmplitude, measured, h), 0.0, 1e-9);
  // Smoothing commutes with a turn over the tones only nearly: the rest of the offset, about 2 ns.
  EXPECT_NEAR(loss.value(LossKind::kDelay, measured, h), 0.0, 2e-3);
  EXPECT_GT(loss.value(LossKind::kDelay, measured, channel(antennas(3))), 0.05);
}

TEST(PaperLoss, AdjointsMatchDifferences) {
  const Loss loss(make_grid(), {9, 2}, 1e-3);
  const auto measured = loss.measure(as_received(channel(antennas(4))), kLineOfSight);
  auto h = channel(antennas(5));
  h[130] *= 1e-2;  // a null
  const auto direction = channel(antennas(6));
  for (const LossKind kind : {LossKind::kDelay, LossKind::kRatioAmplitude}) {
    const auto adjoint = loss.adjoint(kind, measured, h);
    double exact = 0.0;
    constexpr double kStep = 1e-7;
    auto above = h;
    auto below = h;
    for (std::size_t i = 0; i < h.size(); ++i) {
      exact += (std::conj(adjoint[i]) * direction[i]).real();
      above[i] += kStep * direction[i];
      below[i] -= kStep * direction[i];
    }
    const double numeric =
        (loss.value(kind, measured, above) - loss.value(kind, measured, below)) / (2.0 * kStep);
    ASSERT_GT(std::abs(numeric), 1e-3);
    EXPECT_NEAR(exact, numeric, 1e-6 * std::abs(numeric));
  }
}

TEST(PaperLoss, IsLargestForZeroChannels) {
  const Loss loss(make_grid(), {}, 1e-3);
  const auto h = channel(antennas(7));
  const auto measured = loss.measure(h, kLineOfSight);
  const std::vector<Value> silence(h.size());
  for (const LossKind kind : {LossKind::kDelay, LossKind::kRatioAmplitude}) {
    EXPECT_EQ(loss.value(kind, measured, silence), 2.0);
    EXPECT_EQ(loss.adjoint(kind, measured, silence), silence);
  }
}

}  // namespace
}  // namespace rayloc::paper::loss_test
