#include "engine/calibrate/access_point_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "engine/base/constants.h"
#include "engine/observe/alignment.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::access_point_fit_test {
namespace {

// Samples of access point 0 from a device on a grid of `per_axis` squared points.
std::vector<CalibrationSample> survey(const RoomModel& room, int per_axis) {
  std::vector<CalibrationSample> samples;
  for (int i = 0; i < per_axis; ++i) {
    for (int j = 0; j < per_axis; ++j) {
      const Vec3d position{
          -1.1 + 2.2 * (i + 0.5) / per_axis, -0.9 + 1.8 * (j + 0.5) / per_axis, 1.2};
      const auto frames =
          test::frames_at(room, position, {2, 30.0, static_cast<unsigned>(1 + per_axis * i + j)});
      const auto burst = combine_burst(frames, {0, room.grid, room.access_points[0].rx_chains, {}});
      samples.push_back({position, burst.value().h});
    }
  }
  return samples;
}

// Adds a tenth of the power as a tail of echoes that are not traced.
void add_tail(const RoomModel& room,
              double first,
              double decay,
              std::mt19937& random,
              std::vector<std::complex<double>>& h) {
  constexpr int kEchoes = 60;
  std::exponential_distribution<double> after(1.0 / decay);
  std::normal_distribution<double> normal;
  double power = 0.0;
  for (const auto& value : h) {
    power += std::norm(value);
  }
  const double scale = std::sqrt(0.1 * power / static_cast<double>(h.size()) / (2.0 * kEchoes));
  const std::size_t tones = room.grid.size();
  for (std::size_t m = 0; m < h.size() / tones; ++m) {
    for (int echo = 0; echo < kEchoes; ++echo) {
      const double delay = first + after(random);
      const double real = scale * normal(random);
      const std::complex<double> amplitude(real, scale * normal(random));
      for (std::size_t k = 0; k < tones; ++k) {
        h[m * tones + k] +=
            amplitude *
            std::polar(1.0, -2.0 * std::numbers::pi * room.grid.frequency_hz(k) * delay);
      }
    }
  }
}

// The same survey, with such a tail.
std::vector<CalibrationSample> survey_with_tail(const RoomModel& room, double decay) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<CalibrationSample> samples;
  for (int i = 0; i < 60; ++i) {
    const double x = 1.1 * uniform(random);
    const Vec3d position{x, 0.9 * uniform(random), 1.2};
    const RoomAccessPoint& ap = room.access_points[0];
    auto h = test::channel_at(room, ap, position);
    add_tail(room, norm(position - ap.array.pose.position) / kSpeedOfLight, decay, random, h);
    const auto frames =
        test::frames_of(room, {std::move(h), {}, {}}, {2, 30.0, static_cast<unsigned>(i + 1)});
    samples.push_back(
        {position, combine_burst(frames, {0, room.grid, ap.rx_chains, {}}).value().h});
  }
  return samples;
}

// Samples of a device `off` [m] from each point along each axis, standard deviation.
std::vector<CalibrationSample> survey_beside(const RoomModel& room, double off) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal(0.0, off);
  std::vector<CalibrationSample> samples;
  for (const CalibrationSample& at : survey(room, 8)) {
    const Vec3d x = at.position;
    const Vec3d place{x.x + normal(random), x.y + normal(random), x.z + normal(random)};
    const RoomAccessPoint& ap = room.access_points[0];
    const auto frames = test::frames_at(room, place, {2, 40.0, 3});
    samples.push_back({x, combine_burst(frames, {0, room.grid, ap.rx_chains, {}}).value().h});
  }
  return samples;
}

RoomModel uncalibrated(RoomModel room) {
  room.access_points[0].gains = {};
  return room;
}

TEST(AccessPointCalibrator, RecoversTheChainGains) {
  const RoomModel room = test::make_room();
  const AccessPointCalibrator calibrator(uncalibrated(room), 0, survey(room, 6));
  const auto fit = calibrator.fit();
  ASSERT_TRUE(fit) << fit.error().message;
  const ChainGains truth = test::make_gains(room, 0);
  // Up to one factor and one delay: 1 degree and 1 % would leave 4e-4.
  EXPECT_GT(Aligner(room.grid).align(truth.gain, fit->gains.gain).correlation, 0.998);
  EXPECT_EQ(fit->gains.rx_chains, truth.rx_chains);
  EXPECT_EQ(fit->samples_used, 36U);
  EXPECT_LT(calibrator.correlation(nullptr), 0.6);
  EXPECT_GT(calibrator.correlation(&*fit), 0.9);
}

TEST(AccessPointCalibrator, ReportsAnEnclosedAccessPoint) {
  const RoomModel room = test::make_room();
  RoomModel shut = uncalibrated(room);
  shut.access_points[0].array.pose.position.z = -0.1;  // below the floor
  const auto fit = AccessPointCalibrator(shut, 0, survey(room, 3)).fit();
  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error().message,
            "access point " + shut.access_points[0].id +
                ": 0 calibration points can be used, at least 4 are needed; no ray of the plan "
                "leads from it to 9 more: is the access point inside a wall or furniture?");
}

// The gains are those behind a coupling that is known.
TEST(AccessPointCalibrator, RecoversTheGainsOfCoupledAntennas) {
  RoomModel room = test::make_room();
  room.access_points[0].gains.coupling = {
      1.0, {0.0, 0.2}, 0.1, {-0.2, 0.1}, 1.0, 0.15, 0.1, 0.2, 1.0};
  RoomModel surveyed = uncalibrated(room);
  surveyed.access_points[0].gains.coupling = room.access_points[0].gains.coupling;
  const auto samples = survey(room, 6);
  const auto fit = AccessPointCalibrator(surveyed, 0, samples).fit_gains();
  const auto without = AccessPointCalibrator(uncalibrated(room), 0, samples).fit_gains();
  ASSERT_TRUE(fit && without);
  EXPECT_EQ(fit->gains.coupling, surveyed.access_points[0].gains.coupling);
  const Aligner aligner(room.grid);
  const ChainGains truth = test::make_gains(room, 0);
  EXPECT_GT(aligner.align(truth.gain, fit->gains.gain).correlation, 0.996);
  EXPECT_LT(aligner.align(truth.gain, without->gains.gain).correlation, 0.995);
}

TEST(AccessPointCalibrator, RecoversTheYaw) {
  const RoomModel room = test::make_room();
  RoomModel surveyed = uncalibrated(room);
  surveyed.access_points[0].array.pose.orientation.yaw -= 1.5 * kDegree;
  const auto fit = AccessPointCalibrator(surveyed, 0, survey(room, 6)).fit();
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->yaw_offset.value, 1.5 * kDegree, 0.4 * kDegree);
  EXPECT_GT(fit->yaw_offset.sigma, 0.0);
}

// A tail twice as long is distinguished from the other, and neither is the usual one.
TEST(AccessPointCalibrator, RecoversTheDiffuseDecay) {
  const RoomModel room = test::make_room();
  for (const double decay : {10e-9, 30e-9}) {
    const auto fit =
        AccessPointCalibrator(uncalibrated(room), 0, survey_with_tail(room, decay)).fit();
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->error.diffuse_decay.value, decay, 0.25 * decay);
    EXPECT_GT(fit->error.diffuse_decay.sigma, 0.0);
  }
}

// The room is exactly as it is modelled: the survey is wrong, not the places of surfaces.
TEST(AccessPointCalibrator, SeparatesSurveyErrorsFromRoomErrors) {
  const RoomModel room = test::make_room();
  auto samples = survey_beside(room, 0.005);
  const auto held = AccessPointCalibrator(room, 0, samples).fit(ArrayFit::kHeld);
  for (CalibrationSample& sample : samples) {
    sample.survey_sigma = 0.005;
  }
  const auto fit = AccessPointCalibrator(room, 0, samples).fit(ArrayFit::kHeld);
  ASSERT_TRUE(held && fit);
  EXPECT_GT(held->error.plan_tolerance.value, 0.002);
  EXPECT_LT(fit->error.plan_tolerance.value, 0.001);
}

TEST(AccessPointCalibrator, RefusesTooFewPoints) {
  const RoomModel room = test::make_room();
  auto samples = survey(room, 2);
  samples.resize(3);
  const auto fit = AccessPointCalibrator(uncalibrated(room), 0, samples).fit();
  ASSERT_FALSE(fit);
  EXPECT_NE(fit.error().message.find("access point a: 3 calibration points"), std::string::npos)
      << fit.error().message;
}

}  // namespace
}  // namespace rayloc::access_point_fit_test
