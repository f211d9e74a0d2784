#include "daemon/lab/calibrate/calibrate_plan.h"

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/test_paths.h"

namespace rayloc::calibrate_plan_test {
namespace {

using ::testing::Contains;
using ::testing::Field;

const std::string kSite = test::data_path("/sites/meeting_room");

TEST(CalibratePlan, NamesPointsAtSeveralHeights) {
  const auto planned = run_plan({kSite, 25});
  ASSERT_TRUE(planned) << planned.error().message;
  ASSERT_EQ(planned->points.size(), 25U);
  EXPECT_EQ(planned->points[0].name, "p01");
  EXPECT_EQ(planned->points[24].name, "p25");
  std::map<double, int> heights;
  for (std::size_t i = 0; i < planned->points.size(); ++i) {
    const PlannedPoint& point = planned->points[i];
    ++heights[std::round(1000.0 * point.position.z) / 1000.0];
    EXPECT_EQ(std::abs(point.position.z - 1.2) < 1e-9, i % 3 != 2) << point.name;
    EXPECT_LT(std::abs(point.position.x), 1.765);
    EXPECT_LT(std::abs(point.position.y), 1.425);
  }
  // Alternately above and below, so that the points determine the access points' height.
  EXPECT_EQ(heights, (std::map<double, int>{{0.6, 4}, {1.2, 17}, {1.8, 4}}));
}

TEST(CalibratePlan, ListsObjectsWithTooFewPoints) {
  const auto planned = run_plan({kSite, 3});
  ASSERT_TRUE(planned) << planned.error().message;
  const PlanCoverage& coverage = planned->coverage;
  EXPECT_THAT(coverage.weak, Contains(Field(&WeakObject::object, "whiteboard")));
  EXPECT_LT(coverage.enough, coverage.pairs);
  for (const WeakObject& weak : coverage.weak) {
    EXPECT_LT(weak.points, coverage.wanted) << weak.object;
    EXPECT_LE(weak.candidates, coverage.candidates) << weak.object;
  }
}

TEST(CalibratePlan, ReturnsAnErrorWithoutASite) {
  std::vector<std::string> notes;
  Observer observer;
  observer.on_note = [&](const std::string& note) { notes.push_back(note); };
  EXPECT_FALSE(run_plan({"/no/such/site", 3}, observer));
  EXPECT_TRUE(notes.empty());
}

}  // namespace
}  // namespace rayloc::calibrate_plan_test
