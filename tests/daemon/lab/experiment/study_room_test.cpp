#include "daemon/lab/experiment/study_room.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/lab/experiment/study_world.h"
#include "engine/scene/scene.h"
#include "tests/daemon/lab/experiment/small_room.h"

namespace rayloc::study_room_test {
namespace {

using ::testing::HasSubstr;

RoomPlan plan() { return *parse_room_plan(test::small_room_plan(), "room.toml"); }

Condition condition_of(double boxes) {
  Condition condition = default_condition();
  condition.room = "room.toml";
  condition.boxes = boxes;
  return condition;
}

TEST(Furnish, PlacesClutterBesideExistingFurniture) {
  const auto furnished = furnish(plan(), condition_of(3), 1, 0);
  ASSERT_TRUE(furnished) << furnished.error().message;
  ASSERT_EQ(furnished->boxes.size(), 4U);
  for (std::size_t i = 1; i < furnished->boxes.size(); ++i) {
    const PlanBox& box = furnished->boxes[i];
    const double reach = 0.5 * std::hypot(box.size.x, box.size.y);
    EXPECT_GT(box.centre.x - reach, furnished->lower.x);
    EXPECT_LT(box.centre.y + reach, furnished->upper.y);
    EXPECT_DOUBLE_EQ(box.centre.z, 0.5 * box.size.z);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_FALSE(is_in_box(*furnished, box.centre + Vec3d{0, 0, 5}, 0.0));
      const Vec3d between = box.centre - furnished->boxes[j].centre;
      EXPECT_GT(std::hypot(between.x, between.y), reach);
    }
  }
  EXPECT_TRUE(make_room(*furnished, condition_of(3)));
}

TEST(Furnish, DependsOnSeedAndLayoutAlone) {
  const auto first = furnish(plan(), condition_of(2), 1, 0);
  const auto again = furnish(plan(), condition_of(2), 1, 0);
  const auto more = furnish(plan(), condition_of(3), 1, 0);
  const auto other = furnish(plan(), condition_of(2), 1, 1);
  EXPECT_EQ(first->boxes[2].centre, again->boxes[2].centre);
  EXPECT_EQ(first->boxes[2].centre, more->boxes[2].centre);  // one more leaves the others
  EXPECT_NE(first->boxes[2].centre, other->boxes[2].centre);
}

TEST(Furnish, ReportsBoxesAndAccessPointsThatDoNotFit) {
  const auto crowded = furnish(plan(), condition_of(60), 1, 0);
  ASSERT_FALSE(crowded);
  EXPECT_THAT(crowded.error().message, HasSubstr("no room for 60 boxes"));
  Condition three = condition_of(0);
  three.access_points = 3;
  EXPECT_THAT(furnish(plan(), three, 1, 0).error().message, HasSubstr("the plan states 2"));
}

TEST(Furnish, SetsTheHeightOfAccessPoints) {
  Condition condition = condition_of(0);
  condition.access_points = 2;
  condition.ap_height_m = 0.7;
  const auto furnished = furnish(plan(), condition, 1, 0);
  ASSERT_TRUE(furnished) << furnished.error().message;
  for (const SiteAccessPoint& ap : furnished->access_points) {
    EXPECT_EQ(ap.array.pose.position.z, 0.7);
  }
}

TEST(Misplace, MovesWallsAndBoxesByTheStatedDeviation) {
  Condition condition = condition_of(0);
  EXPECT_EQ(misplace(plan(), condition, 1, 0).upper, plan().upper);
  condition.plan_error_m = 0.01;
  double sum = 0.0;
  constexpr int kLayouts = 400;
  for (std::size_t layout = 0; layout < kLayouts; ++layout) {
    const RoomPlan moved = misplace(plan(), condition, 1, layout);
    const double by = moved.boxes[0].centre.x - plan().boxes[0].centre.x;
    sum += by * by;
    EXPECT_EQ(moved.lower.z, plan().lower.z);
  }
  EXPECT_NEAR(std::sqrt(sum / kLayouts), 0.01, 0.001);
}

TEST(IsInBox, FollowsTheRotationOfTheBox) {
  RoomPlan room = plan();
  room.boxes[0].size = {1.0, 0.2, 1.5};
  room.boxes[0].yaw = 0.5 * std::acos(-1.0);
  const Vec3d centre = room.boxes[0].centre;
  EXPECT_TRUE(is_in_box(room, centre + Vec3d{0.0, 0.45, 0.0}, 0.0));
  EXPECT_FALSE(is_in_box(room, centre + Vec3d{0.45, 0.0, 0.0}, 0.0));
  EXPECT_FALSE(is_in_box(room, centre + Vec3d{0.0, 0.0, 0.8}, 0.0));
  EXPECT_TRUE(is_in_box(room, centre + Vec3d{0.0, 0.0, 0.8}, 0.1));
}

class SimulateWorld : public ::testing::Test {
 protected:
  SimulateWorld() : folder_("world-test"), condition_(default_condition()) {
    condition_.room = folder_.path() / "room.toml";
    condition_.test_points = 3;
    condition_.frames = 2;
    condition_.depth = 1;
  }
  test::SmallRoomFolder folder_;
  Condition condition_;
};

TEST_F(SimulateWorld, ReceivesEveryPointAtEveryAccessPoint) {
  condition_.access_points = 2;
  condition_.layouts = 2;
  const auto layouts = simulate_world(condition_, 1);
  ASSERT_TRUE(layouts) << layouts.error().message;
  ASSERT_EQ(layouts->size(), 2U);
  for (const StudyLayout& layout : *layouts) {
    ASSERT_EQ(layout.test_points.size(), 3U);
    for (const StudyPoint& test_point : layout.test_points) {
      EXPECT_EQ(test_point.frames.size(), 4U);
      EXPECT_DOUBLE_EQ(test_point.position.z, 1.2);
    }
    for (const RoomAccessPoint& ap : layout.model.access_points) {
      EXPECT_EQ(ap.gains.gain.size(), 3 * layout.model.grid.size());
    }
  }
  EXPECT_NE((*layouts)[0].test_points[0].position, (*layouts)[1].test_points[0].position);
}

TEST_F(SimulateWorld, PointsAreWhereTheyWereAskedFor) {
  const Vec3d ap{0.3, 0.3, 1.2};
  condition_.distance_m = 2.0;
  const auto at_distance = simulate_world(condition_, 1);
  ASSERT_TRUE(at_distance) << at_distance.error().message;
  for (const StudyPoint& test_point : at_distance->front().test_points) {
    EXPECT_NEAR(norm(test_point.position - ap), 2.0, 0.25);
  }
  condition_.distance_m = 0.0;
  condition_.sight = "nlos";
  const auto hidden = simulate_world(condition_, 1);
  ASSERT_TRUE(hidden) << hidden.error().message;
  for (const StudyPoint& test_point : hidden->front().test_points) {
    EXPECT_TRUE(hidden->front().model.scene->is_blocked({ap, test_point.position}));
  }
  condition_.distance_m = 40.0;
  EXPECT_THAT(simulate_world(condition_, 1).error().message,
              HasSubstr("hardly a place with sight \"nlos\""));
}

TEST_F(SimulateWorld, ReceivesAFixedTransmitterWithAndWithoutPeople) {
  condition_.kind = "person";
  condition_.access_points = 2;
  const auto layouts = simulate_world(condition_, 1);
  ASSERT_TRUE(layouts) << layouts.error().message;
  const StudyLayout& layout = layouts->front();
  ASSERT_TRUE(layout.transmitter);
  EXPECT_EQ(layout.empty.size(), 40U);
  for (const StudyPoint& test_point : layout.test_points) {
    EXPECT_EQ(test_point.frames.size(), 4U);
    EXPECT_GT(norm(test_point.position - layout.transmitter->position), condition_.person_radius_m);
  }
  EXPECT_GT(layout.test_points.front().frames.front().time, layout.empty.back().time);
  condition_.kind = "device";
  EXPECT_FALSE(simulate_world(condition_, 1)->front().transmitter);
}

}  // namespace
}  // namespace rayloc::study_room_test
