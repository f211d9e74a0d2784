#include "engine/localize/search_area.h"
#include "engine/grid/grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "engine/localize/localizer.h"
#include "engine/scene/scene.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::search_area_test {
namespace {

// The room, of which only the half with x < 0.2 m is the area, with one access point.
RoomModel half_room() {
  RoomModel room = test::make_room();
  room.bounds_max.x = 0.2;
  room.access_points.resize(1);
  room.access_points[0].error.plan_tolerance = 0.001;
  room.access_points[0].error.diffuse = 0.005;
  return room;
}

TEST(SearchArea, IsTheRoomWhereTheSceneReachesNoFurther) {
  const RoomModel room = test::make_room();
  const SearchArea area = search_area(room);
  EXPECT_TRUE(area.inside.empty());
  std::vector<double> map(area.grid.size(), -1.0);
  EXPECT_EQ(take_outside(area, 1.0, map), 0.0);
  EXPECT_EQ(map, std::vector<double>(area.grid.size(), -1.0));
}

TEST(SearchArea, HoldsTheCellsOfTheAreaAndThoseBesideIt) {
  const RoomModel room = half_room();
  const Grid inner(room.bounds_min, room.bounds_max, room.device.height, 0.05);
  const SearchArea area = search_area(room);
  ASSERT_EQ(area.inside.size(), area.grid.size());
  EXPECT_EQ(static_cast<std::size_t>(std::accumulate(area.inside.begin(), area.inside.end(), 0)),
            inner.size());
  std::size_t at = 0;
  for (std::size_t i = 0; i < area.grid.size(); ++i) {
    const Vec3d p = area.grid.centre(i);
    EXPECT_LT(p.x, room.scene->bounds_max().x + area.grid.step_x);
    if (area.inside[i] != 0) {
      EXPECT_NEAR(norm(p - inner.centre(at++)), 0.0, 1e-9);
    } else {
      EXPECT_GT(p.x, room.bounds_max.x);
    }
  }
}

TEST(SearchArea, TakesTheShareThatIsOutside) {
  const SearchArea area = search_area(half_room());
  std::vector<double> map(area.grid.size(), -1000.0);
  const auto outside = static_cast<std::size_t>(
      std::find(area.inside.begin(), area.inside.end(), 0) - area.inside.begin());
  const auto inside = static_cast<std::size_t>(
      std::find(area.inside.begin(), area.inside.end(), 1) - area.inside.begin());
  map[inside] = 4.0;
  map[outside] = 4.0 + 2.0 * std::log(3.0);  // three times as probable, at an exponent of 0.5
  EXPECT_NEAR(take_outside(area, 0.5, map), 0.75, 1e-9);
  EXPECT_EQ(map[inside], 4.0);
  EXPECT_LT(map[outside], -1000.0);
}

// No other access point contradicts the first; the scene does.
TEST(SearchArea, GivesNoPositionForADeviceOutsideTheArea) {
  const auto room = std::make_shared<const RoomModel>(half_room());
  const Localizer localizer = *Localizer::create(room, {});
  int none = 0;
  for (const Vec3d beside : {Vec3d{0.9, 0.3, 1.2}, Vec3d{0.7, -0.5, 1.2}, Vec3d{1.1, -0.2, 1.2}}) {
    const LocationEstimate estimate = localizer.locate(test::frames_at(*room, beside));
    none += estimate.position ? 0 : 1;
    if (!estimate.position) {
      EXPECT_NE(estimate.reason.find("beside the area"), std::string::npos) << estimate.reason;
    }
  }
  EXPECT_GE(none, 2);
  const Vec3d within{-0.6, 0.2, 1.2};
  const LocationEstimate estimate = localizer.locate(test::frames_at(*room, within));
  ASSERT_TRUE(estimate.position) << estimate.reason;
  EXPECT_LT(std::hypot(estimate.position->x - within.x, estimate.position->y - within.y), 0.1);
}

}  // namespace
}  // namespace rayloc::search_area_test
