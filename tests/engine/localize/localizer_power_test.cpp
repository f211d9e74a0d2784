// The received power of a transmitter of constant power, from frames to a position.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/constants.h"
#include "engine/grid/grid.h"
#include "engine/localize/access_point_map.h"
#include "engine/localize/localizer.h"
#include "tests/support/scenes.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::localizer_power_test {
namespace {

const MacAddress kDevice = *parse_mac_address("02:52:4c:00:00:01");
const MacAddress kStranger = *parse_mac_address("02:52:4c:00:00:02");
constexpr double kAtOneMetre = -40.0;  // [dBm], of the device
constexpr double kDipole = 1.6409;     // gain of a half-wave dipole across its axis

const Vec3d kAccessPoint{-2.4, 0.0, 1.2};

// Nothing but air, and an access point with two antennas: they measure a bearing and no distance.
RoomModel make_field() {
  RoomModel room = test::make_room();
  room.scene = test::make_scene({{"stone", test::box_mesh({0.0, 0.0, -90.0}, {0.1, 0.1, -89.9})}},
                                test::kConcrete);
  room.bounds_min = {-2.5, -2.0, 0.0};
  room.bounds_max = {2.5, 2.0, 2.5};
  room.access_points.resize(1);
  RoomAccessPoint& ap = room.access_points[0];
  const double half = 0.25 * kSpeedOfLight / test::kCarrier;
  ap.array.pose.position = kAccessPoint;
  ap.array.pose.orientation.yaw = 0.0;
  ap.array.element_offset = {{0.0, -half, 0.0}, {0.0, half, 0.0}};
  ap.rx_chains = {0, 1};
  ap.gains = test::make_gains(room, 0);
  ap.error.diffuse_exponent = 0.0;
  return room;
}

// As a calibration would have learned it: of free space between half-wave dipoles.
TransmitterPower known_power(const RoomModel& room) {
  const double at_one_metre = kDipole * kSpeedOfLight / test::kCarrier / (4.0 * std::numbers::pi);
  const double traced =
      10.0 * std::log10(at_one_metre * at_one_metre * (1.0 + room.access_points[0].error.diffuse));
  return {kDevice, kAtOneMetre - traced, 0.5};
}

RoomModel with_power(RoomModel room) {
  room.access_points[0].powers = {known_power(room)};
  return room;
}

// Frames of the device at 2 m, with the power that it has at `distance`.
std::vector<CsiFrame> received_at(const RoomModel& room, std::optional<double> distance) {
  auto frames = test::frames_at(room, kAccessPoint + Vec3d{2.0, 0.0, 0.0});
  for (CsiFrame& frame : frames) {
    frame.transmitter = kDevice;
    if (distance) {
      const double power = kAtOneMetre - 20.0 * std::log10(*distance);
      frame.power_dbm.assign(frame.rx_chains.size(), static_cast<float>(power));
    }
  }
  return frames;
}

// Share of the posterior's mass that is within 0.4 m of the place that far in front.
double mass_at(const Localizer& localizer, std::span<const CsiFrame> frames, double distance) {
  const auto evidence = localizer.evidence(localizer.receive(frames));
  const Vec3d place = kAccessPoint + Vec3d{distance, 0.0, 0.0};
  double near = 0.0;
  double all = 0.0;
  for (std::size_t cell = 0; cell < evidence.log_likelihood.size(); ++cell) {
    const double mass =
        std::exp(localizer.room().likelihood_exponent * evidence.log_likelihood[cell]);
    all += mass;
    near += norm(localizer.grid().centre(cell) - place) < 0.4 ? mass : 0.0;
  }
  return near / all;
}

Localizer localizer_in(RoomModel room) {
  return *Localizer::create(std::make_shared<const RoomModel>(std::move(room)), {});
}

void expect_same(const LocationEstimate& a, const LocationEstimate& b) {
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.accuracy_m, b.accuracy_m);
  EXPECT_EQ(a.loss, b.loss);
  EXPECT_EQ(a.residual_probability, b.residual_probability);
  EXPECT_EQ(a.model_residual_db, b.model_residual_db);
  EXPECT_EQ(a.warnings, b.warnings);
  ASSERT_EQ(a.hypotheses.size(), b.hypotheses.size());
  for (std::size_t i = 0; i < a.hypotheses.size(); ++i) {
    EXPECT_EQ(a.hypotheses[i].position, b.hypotheses[i].position);
    EXPECT_EQ(a.hypotheses[i].weight, b.hypotheses[i].weight);
  }
}

TEST(LocalizerPower, MovesTheMassToItsDistance) {
  const Localizer without = localizer_in(make_field());
  const Localizer with = localizer_in(with_power(make_field()));
  for (const double distance : {1.0, 2.0, 3.5}) {
    const auto frames = received_at(with.room(), distance);
    EXPECT_LT(mass_at(without, frames, distance), 0.4) << distance;
    EXPECT_GT(mass_at(with, frames, distance), 0.8) << distance;
    const LocationEstimate estimate = with.locate(frames);
    ASSERT_TRUE(estimate.position) << estimate.reason;
    EXPECT_NEAR(estimate.position->x, kAccessPoint.x + distance, 0.3);
    EXPECT_NEAR(estimate.position->y, 0.0, 0.3);
  }
}

// Its spread was measured: it is as sure with any exponent of the likelihood.
TEST(LocalizerPower, IsNotTempered) {
  const Localizer with = localizer_in(with_power(make_field()));
  const auto frames = received_at(with.room(), 2.0);
  double most = 0.0;
  double least = 10.0;
  for (const double likelihood_exponent : {0.2, 0.6, 1.8}) {
    const LocationEstimate estimate = with.locate(frames, likelihood_exponent);
    ASSERT_TRUE(estimate.position) << likelihood_exponent;
    // Along the line of sight, where only the power determines the place.
    most = std::max(most, std::sqrt(estimate.covariance[0]));
    least = std::min(least, std::sqrt(estimate.covariance[0]));
  }
  // 0.5 dB at 2 m, and the residual probability of bursts without information.
  EXPECT_LT(most, 1.25 * least);
}

TEST(LocalizerPower, ChangesNothingIfUnknownOrMissing) {
  const Localizer without = localizer_in(make_field());
  const Localizer with = localizer_in(with_power(make_field()));
  const auto silent = received_at(with.room(), std::nullopt);
  auto strange = received_at(with.room(), 1.0);
  for (CsiFrame& frame : strange) {
    frame.transmitter = kStranger;
  }
  const LocationEstimate usual = without.locate(silent);
  expect_same(without.locate(received_at(with.room(), 1.0)), usual);
  expect_same(with.locate(silent), usual);
  expect_same(with.locate(strange), usual);
}

// That of the antennas that are left was not learned.
TEST(LocalizerPower, IsIgnoredWithADeadChain) {
  RoomModel room = test::make_room();
  auto frames = test::frames_at(room, {0.3, 0.2, 1.2});
  for (CsiFrame& frame : frames) {
    frame.transmitter = kDevice;
    frame.power_dbm.assign(frame.rx_chains.size(), -60.0F);
    if (frame.access_point == 0) {
      for (std::complex<float>& value : frame.csi.row(1, 0)) {
        value *= 0.02F;
      }
    }
  }
  const LocationEstimate usual = localizer_in(room).locate(frames);
  room.access_points[0].powers = {{kDevice, -10.0, 1.0}};
  const LocationEstimate estimate = localizer_in(room).locate(frames);
  ASSERT_TRUE(estimate.position) << estimate.reason;
  ASSERT_EQ(estimate.antennas_used, 8U);
  expect_same(estimate, usual);
}

TEST(LocalizerPower, HasAMeanLikelihoodOfOneOverTheRoom) {
  const auto room = std::make_shared<const RoomModel>(make_field());
  const Grid grid(room->bounds_min, room->bounds_max, 1.2, 0.25);
  const AccessPointMap map(AccessPointMap::Source{room, 0, grid, LikelihoodKind::kPartial},
                           nullptr);
  const double offset = known_power(*room).offset_db;
  const double sigma = 3.0;
  const double power = kAtOneMetre - 20.0 * std::log10(2.0);
  const auto of_cells = map.power_log_likelihood({power - offset, sigma});
  ASSERT_EQ(of_cells.size(), grid.size());
  double mean = 0.0;
  for (const double one : of_cells) {
    mean += std::exp(one) / static_cast<double>(grid.size());
  }
  EXPECT_NEAR(mean, 1.0, 1e-9);
  // Between two cells: the Gaussians of their distances.
  const auto gaussian = [&](std::size_t cell) {
    const double off = 20.0 * std::log10(norm(grid.centre(cell) - kAccessPoint) / 2.0);
    return -0.5 * off * off / (sigma * sigma);
  };
  const std::size_t near = grid.size() / 3;
  const std::size_t far = grid.size() - 1;
  EXPECT_NEAR(of_cells[far] - of_cells[near], gaussian(far) - gaussian(near), 0.03);
}

}  // namespace
}  // namespace rayloc::localizer_power_test
