#include "daemon/lab/simulate/transmissions.h"

#include <chrono>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::transmissions_test {
namespace {

using std::chrono::milliseconds;
using ::testing::StartsWith;

SurveyPoint point(int start_ms, int end_ms, const Vec3d& position, int line) {
  return {Timestamp(milliseconds(start_ms)), Timestamp(milliseconds(end_ms)), position, line};
}

TEST(Transmissions, AreSpreadEvenlyOverThePointsTime) {
  const std::vector<SurveyPoint> points = {point(1000, 2000, {1, 2, 3}, 2)};
  const auto test_points = plan_transmissions(points, {.frames = 4}, "f.csv");
  ASSERT_TRUE(test_points);
  ASSERT_EQ(test_points->size(), 1U);
  EXPECT_EQ((*test_points)[0].position, (Vec3d{1, 2, 3}));
  std::vector<Timestamp> times;
  for (const Transmission& frame : (*test_points)[0].frames) {
    times.push_back(frame.time);
  }
  EXPECT_EQ(times,
            (std::vector<Timestamp>{Timestamp(milliseconds(1125)),
                                    Timestamp(milliseconds(1375)),
                                    Timestamp(milliseconds(1625)),
                                    Timestamp(milliseconds(1875))}));
}

TEST(Transmissions, CycleThroughTheChannels) {
  const std::vector<SurveyPoint> points = {point(0, 1000, {}, 2), point(1000, 2000, {}, 3)};
  const auto test_points = plan_transmissions(points, {.frames = 4, .channels = 3}, "f.csv");
  ASSERT_TRUE(test_points);
  std::vector<std::size_t> channels;
  for (const SimulatedPoint& test_point : *test_points) {
    for (const Transmission& frame : test_point.frames) {
      channels.push_back(frame.channel);
    }
  }
  EXPECT_EQ(channels, (std::vector<std::size_t>{0, 1, 2, 0, 1, 2, 0, 1}));
}

TEST(Transmissions, FollowTheClockNotTheFile) {
  const std::vector<SurveyPoint> points = {point(5000, 6000, {}, 2), point(1000, 2000, {}, 3)};
  const auto test_points = plan_transmissions(points, {}, "f.csv");
  ASSERT_TRUE(test_points);
  EXPECT_EQ((*test_points)[0].line, 3);
  EXPECT_EQ((*test_points)[1].line, 2);
}

TEST(Transmissions, RetriesRepeatTheNumberOfTheFrameBefore) {
  const std::vector<SurveyPoint> points = {point(0, 100'000, {}, 2)};
  const auto test_points =
      plan_transmissions(points, {.frames = 10'000, .retry_share = 0.3, .seed = 4}, "f.csv");
  ASSERT_TRUE(test_points);
  int retries = 0;
  const auto& frames = (*test_points)[0].frames;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const int step = (frames[i].sequence_control - frames[i - 1].sequence_control) & 0xffff;
    ASSERT_TRUE(step == 0 || step == 16) << step;
    retries += step == 0 ? 1 : 0;
  }
  EXPECT_NEAR(retries, 3000, 3 * 46);
}

TEST(Transmissions, TheSurveyErrorIsItsDeviationAlongEachAxis) {
  std::vector<SurveyPoint> points;
  points.reserve(2000);
  for (int i = 0; i < 2000; ++i) {
    points.push_back(point(100 * i, 100 * i + 90, {1, 2, 3}, i + 2));
  }
  const auto test_points = plan_transmissions(points, {.frames = 1, .survey_error = 0.01}, "f.csv");
  ASSERT_TRUE(test_points);
  Vec3d squares;
  for (const SimulatedPoint& test_point : *test_points) {
    const Vec3d off = test_point.position - Vec3d{1, 2, 3};
    squares = squares + Vec3d{off.x * off.x, off.y * off.y, off.z * off.z};
  }
  EXPECT_NEAR(std::sqrt(squares.x / 2000), 0.01, 0.0006);
  EXPECT_NEAR(std::sqrt(squares.y / 2000), 0.01, 0.0006);
  EXPECT_NEAR(std::sqrt(squares.z / 2000), 0.01, 0.0006);
}

TEST(Transmissions, AWalkIsAFrameAtEachInstant) {
  const std::vector<SurveyPoint> points = {point(1050, 1050, {1.1, 2, 3}, 3),
                                           point(1000, 1000, {1, 2, 3}, 2)};
  const auto test_points = plan_transmissions(points, {.frames = 10, .walk = true}, "f.csv");
  ASSERT_TRUE(test_points) << test_points.error().message;
  ASSERT_EQ(test_points->size(), 2U);
  ASSERT_EQ((*test_points)[1].frames.size(), 1U);
  EXPECT_EQ((*test_points)[0].frames[0].time, Timestamp(milliseconds(1000)));
  EXPECT_EQ((*test_points)[1].frames[0].time, Timestamp(milliseconds(1050)));
  EXPECT_EQ((*test_points)[1].position, (Vec3d{1.1, 2, 3}));
  const std::vector<SurveyPoint> at_once = {point(1000, 1000, {}, 2), point(1000, 1000, {}, 3)};
  EXPECT_THAT(plan_transmissions(at_once, {.walk = true}, "f.csv").error().message,
              StartsWith("f.csv:3: follows within 0.2 ms of line 2"));
}

TEST(Transmissions, RefusesRowsThatOverlapOrAreTooShort) {
  const std::vector<SurveyPoint> overlapping = {point(0, 1000, {}, 2), point(900, 2000, {}, 3)};
  EXPECT_THAT(plan_transmissions(overlapping, {}, "f.csv").error().message,
              StartsWith("f.csv:3: begins before the point of line 2 ends"));
  const std::vector<SurveyPoint> brief = {point(0, 1, {}, 2)};
  EXPECT_THAT(plan_transmissions(brief, {.frames = 10}, "f.csv").error().message,
              StartsWith("f.csv:2: 10 frames do not fit"));
}

}  // namespace
}  // namespace rayloc::transmissions_test
