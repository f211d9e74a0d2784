#include "engine/calibrate/joint/multi_start.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/support/surveyed_room.h"

namespace rayloc::multi_start_test {
namespace {

const test::SurveyedRoom& survey() {
  static const test::SurveyedRoom kSurvey =
      test::make_surveyed_room({.points = 30, .trace = {.max_depth = 2}});
  return kSurvey;
}

JointCalibrationOptions options_of(std::uint64_t seed) {
  JointCalibrationOptions options;
  options.trace = survey().plan.trace;
  options.use = survey().plan.trace;
  options.iterations = 4;
  options.seed = seed;
  return options;
}

RoomCalibration by_draw(std::uint64_t seed) {
  return calibrate_jointly(survey().plan, survey().points, options_of(seed), {}).value();
}

std::vector<double> numbers(const RoomCalibration& calibration) {
  std::vector<double> result;
  for (const RoomParameter& parameter : calibration.parameters) {
    result.push_back(parameter.value);
  }
  return result;
}

// Bursts at access points count: three access points receive three times as many.
TEST(MultiStart, UsesMoreStartsForFewerBursts) {
  const auto received = [](std::size_t points, std::size_t access_points) {
    CalibrationPoint point;
    point.h.assign(access_points, {1.0});
    point.h.emplace_back();  // an access point without a burst
    return usual_draws(std::vector<CalibrationPoint>(points, point));
  };
  EXPECT_EQ(received(72, 1), 3);
  EXPECT_EQ(received(143, 1), 2);
  EXPECT_EQ(received(72, 2), 2);
  EXPECT_EQ(received(143, 3), 1);
}

TEST(MultiStart, KeepsTheRunWhoseRoomMeetsThePointsBest) {
  const RoomCalibration first = by_draw(3);
  const RoomCalibration second = by_draw(4);
  const double of_first = left_unexplained(survey().points, first);
  const double of_second = left_unexplained(survey().points, second);
  ASSERT_NE(of_first, of_second);
  const auto kept =
      calibrate_from_draws(survey().plan, survey().points, options_of(3), 2, {}).value();
  EXPECT_EQ(numbers(kept), numbers(of_first < of_second ? first : second));
  // The other order, the same room.
  const auto alone =
      calibrate_from_draws(survey().plan, survey().points, options_of(4), 1, {}).value();
  EXPECT_EQ(numbers(alone), numbers(second));
}

TEST(MultiStart, HeldOutPointsDoNotCount) {
  RoomCalibration calibration = by_draw(3);
  const double before = left_unexplained(survey().points, calibration);
  for (PointFit& fit : calibration.points) {
    fit.placed = survey().points[fit.point].held_out ? 0.0 : fit.placed;
  }
  EXPECT_EQ(left_unexplained(survey().points, calibration), before);
}

TEST(MultiStart, ReportsOneShareAndCheckpointsOfTheFirst) {
  double last = 0.0;
  int checkpoints = 0;
  JointCalibrationOptions options = options_of(3);
  options.on_checkpoint = [&](const JointCheckpoint&) {
    ++checkpoints;
    EXPECT_LT(last, 0.5);
  };
  const auto observe = [&](const CalibrationProgress& progress) {
    EXPECT_GE(progress.share, last);
    EXPECT_LE(progress.share, 1.0);
    last = progress.share;
    return true;
  };
  ASSERT_TRUE(calibrate_from_draws(survey().plan, survey().points, options, 2, observe));
  EXPECT_GT(last, 0.9);
  EXPECT_EQ(checkpoints, 5);
}

TEST(MultiStart, AnInterruptionLeavesTheBestSoFar) {
  const auto stopped =
      calibrate_from_draws(survey().plan,
                           survey().points,
                           options_of(3),
                           2,
                           [](const CalibrationProgress& progress) { return progress.share < 0.6; })
          .value();
  EXPECT_TRUE(stopped.interrupted);
  EXPECT_EQ(numbers(stopped), numbers(by_draw(3)));
}

}  // namespace
}  // namespace rayloc::multi_start_test
