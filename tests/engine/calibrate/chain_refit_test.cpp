#include "engine/calibrate/chain_refit.h"

#include <cmath>
#include <complex>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/constants.h"
#include "engine/observe/burst.h"
#include "engine/observe/chain_gains.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::chain_refit_test {
namespace {

using ::testing::HasSubstr;
using Value = std::complex<double>;

constexpr UsualFit kUsual{0.97, 0.95, 0.98};

// The room of the tests as it was calibrated before a power cycle: frames_at() makes the chains of
// after it.
RoomModel before_the_power_cycle(const std::vector<double>& turn_deg) {
  RoomModel room = test::make_room();
  for (RoomAccessPoint& ap : room.access_points) {
    ap.error.plan_tolerance = 0.002;
    for (std::size_t m = 0; m < ap.rx_chains.size(); ++m) {
      for (std::size_t k = 0; k < room.grid.size(); ++k) {
        ap.gains.gain[m * room.grid.size() + k] *= std::polar(1.0, -turn_deg[m] * kDegree);
      }
    }
  }
  return room;
}

ReferencePoint receive(const RoomModel& room, const Vec3d& position, unsigned seed = 1) {
  const auto frames = test::frames_at(room, position, {8, 30.0, seed});
  return {position,
          room.device,
          combine_burst(frames, {0, room.grid, room.access_points[0].rx_chains, {}}).value().h};
}

// Mean phase of chain `m` against the first, of one set of gains less another [rad].
double turn_between(const ChainGains& from, const ChainGains& to, std::size_t m) {
  const std::size_t tones = from.grid.size();
  const auto ratio = [&](const ChainGains& gains) {
    Value sum;
    for (std::size_t k = 0; k < tones; ++k) {
      sum += gains.gain[m * tones + k] * std::conj(gains.gain[k]);
    }
    return sum;
  };
  return std::arg(ratio(to) * std::conj(ratio(from)));
}

void expect_true_phases(const ChainRefit& refit, double tolerance) {
  const ChainGains truth = test::make_gains(test::make_room(), 0);
  for (std::size_t m = 1; m < 3; ++m) {
    const double error = std::abs(turn_between(truth, refit.gains, m));
    EXPECT_LT(error, tolerance) << m;
    EXPECT_LT(error, 3.0 * std::hypot(refit.sigma[m], refit.sigma[0])) << m;
  }
}

TEST(RefitChains, FindsThePhasesFromOnePoint) {
  const RoomModel room = before_the_power_cycle({0.0, 180.0, 90.0});
  const std::vector<ReferencePoint> points = {receive(room, {0.4, -0.2, 1.1})};
  const auto refit = refit_chains(room, 0, points, {0.01, kUsual});
  ASSERT_TRUE(refit) << refit.error().message;
  EXPECT_EQ(refit->points, 1U);
  EXPECT_FALSE(refit->ripple);
  EXPECT_GT(refit->fit, 0.98);
  expect_true_phases(*refit, 3.0 * kDegree);
}

TEST(RefitChains, ThreePointsStateASmallerUncertaintyThanOne) {
  const RoomModel room = before_the_power_cycle({30.0, -120.0, 75.0});
  const std::vector<ReferencePoint> points = {receive(room, {0.4, -0.2, 1.1}, 1),
                                              receive(room, {-0.5, -0.6, 1.2}, 2),
                                              receive(room, {0.9, 0.3, 1.3}, 3)};
  const auto one = refit_chains(room, 0, std::span(points).first(1));
  const auto three = refit_chains(room, 0, points);
  ASSERT_TRUE(one && three);
  expect_true_phases(*three, 3.0 * kDegree);
  EXPECT_LT(three->sigma[1], one->sigma[1]);
  EXPECT_GT(three->sigma[1], 0.0);
}

// A room that explains little would yield phases that are far off; the channel before the power
// cycle is compared with the present channel, whatever its paths.
TEST(RefitChains, ComparesATransmitterWithItsUsualChannel) {
  const std::vector<double> turn = {0.0, 180.0, 90.0};
  RoomModel room = before_the_power_cycle(turn);
  for (RoomAccessPoint& ap : room.access_points) {
    ap.error.plan_tolerance = 0.03;
  }
  const Vec3d place{0.4, -0.2, 1.1};
  ReferencePoint point = receive(room, place, 2);
  point.usual = receive(room, place, 3).h;
  remove_gains(test::make_gains(test::make_room(), 0), point.usual);
  const auto refit = refit_chains(room, 0, std::span(&point, 1));
  ASSERT_TRUE(refit) << refit.error().message;
  EXPECT_GT(refit->fit, 0.99);
  expect_true_phases(*refit, 3.0 * kDegree);
}

TEST(RefitChains, KeepsTheCouplingOfTheAntennas) {
  RoomModel room = before_the_power_cycle({0.0, 180.0, 90.0});
  room.access_points[0].gains.coupling = {
      1.0, {0.0, 0.2}, 0.1, {-0.2, 0.1}, 1.0, 0.15, 0.1, 0.2, 1.0};
  const std::vector<ReferencePoint> points = {receive(room, {0.4, -0.2, 1.1})};
  const auto refit = refit_chains(room, 0, points, {0.01, kUsual});
  ASSERT_TRUE(refit) << refit.error().message;
  EXPECT_EQ(refit->gains.coupling, room.access_points[0].gains.coupling);
  EXPECT_GT(refit->fit, 0.98);
  expect_true_phases(*refit, 4.0 * kDegree);
}

// The prediction of a chain is not its measurement: the chain keeps about its former gain, and its
// phase is rejected.
TEST(RefitChains, KeepsGainsThatThePointCannotDetermine) {
  RoomModel room = before_the_power_cycle({0.0, 0.0, 0.0});
  const std::size_t tones = room.grid.size();
  ReferencePoint point = receive(room, {0.4, -0.2, 1.1});
  for (std::size_t k = 0; k < tones; ++k) {
    point.h[2 * tones + k] *= 0.2 * std::cos(0.2 * static_cast<double>(k));
  }
  EXPECT_THAT(refit_chains(room, 0, std::span(&point, 1)).error().message,
              HasSubstr("the phase of core 3 would be known to"));
  const auto refit = refit_chains(room, 0, std::span(&point, 1), {0.01, {}, 10.0});
  ASSERT_TRUE(refit) << refit.error().message;
  const auto log_gain = [&](const ChainGains& gains, std::size_t m) {
    double sum = 0.0;
    for (std::size_t k = 0; k < tones; ++k) {
      sum += std::norm(gains.gain[m * tones + k]);
    }
    return 10.0 * std::log10(sum);
  };
  const ChainGains& before = room.access_points[0].gains;
  EXPECT_LT(std::abs(log_gain(refit->gains, 2) - log_gain(refit->gains, 0) - log_gain(before, 2) +
                     log_gain(before, 0)),
            2.0);
}

TEST(RefitChains, ManyPointsDetermineTheRipple) {
  RoomModel room = before_the_power_cycle({0.0, 180.0, 90.0});
  for (std::size_t k = 0; k < room.grid.size(); ++k) {
    room.access_points[0].gains.gain[k] *=
        std::polar(1.0, 0.4 * std::sin(0.05 * static_cast<double>(k)));
  }
  std::vector<ReferencePoint> points;
  for (unsigned i = 0; i < 16; ++i) {
    const unsigned row = i / 4;
    points.push_back(receive(room, {-0.9 + 0.6 * (i % 4), -0.8 + 0.5 * row, 1.2}, i + 1));
  }
  const auto refit = refit_chains(room, 0, points);
  ASSERT_TRUE(refit);
  EXPECT_TRUE(refit->ripple);
  EXPECT_GT(refit->fit, 0.98);
  expect_true_phases(*refit, 3.0 * kDegree);
}

TEST(RefitChains, RefusesPlacesThatContradictEachOther) {
  const RoomModel room = before_the_power_cycle({0.0, 0.0, 0.0});
  std::vector<ReferencePoint> points;
  for (unsigned i = 0; i < 6; ++i) {
    const unsigned row = i / 3;
    points.push_back(receive(room, {-0.9 + 0.6 * (i % 3), -0.6 + 0.9 * row, 1.2}, i + 1));
    points.back().position.x *= -1.0;
  }
  const auto refit = refit_chains(room, 0, points, {0.01, kUsual});
  ASSERT_FALSE(refit) << refit->fit;
  EXPECT_EQ(refit.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(refit.error().message, HasSubstr("access point a"));
  EXPECT_THAT(refit.error().message, HasSubstr("the calibration 0.970"));
}

TEST(RefitChains, RefusesAPlaceThatNoRayReaches) {
  const RoomModel room = before_the_power_cycle({0.0, 0.0, 0.0});
  std::vector<ReferencePoint> points = {receive(room, {0.4, -0.2, 1.1})};
  points[0].position = {20.0, 0.0, 1.1};
  const auto refit = refit_chains(room, 0, points);
  ASSERT_FALSE(refit);
  EXPECT_THAT(refit.error().message, HasSubstr("no ray"));
}

}  // namespace
}  // namespace rayloc::chain_refit_test
