#include "daemon/lab/evaluate/fingerprint_map.h"

#include <gtest/gtest.h>

#include "tests/support/synthetic_room.h"

namespace rayloc::fingerprint_map_test {
namespace {

using test::frames_at;
using test::make_room;

std::vector<FingerprintMap::AccessPoint> access_points_of(const RoomModel& room) {
  std::vector<FingerprintMap::AccessPoint> all;
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    all.push_back({i, room.access_points[i].rx_chains});
  }
  return all;
}

std::vector<CsiFrame> only(std::vector<CsiFrame> frames, std::size_t access_point) {
  std::erase_if(frames, [&](const CsiFrame& frame) { return frame.access_point != access_point; });
  return frames;
}

class FingerprintMapTest : public ::testing::Test {
 protected:
  FingerprintMapTest() : room_(make_room()), map_(room_.grid, access_points_of(room_)) {
    for (const Vec3d& place : places_) {
      EXPECT_TRUE(map_.add(place, frames_at(room_, place, {.seed = 1})));
    }
  }

  const std::vector<Vec3d> places_ = {
      {-0.5, 0.1, 1.2}, {0.0, -0.4, 1.2}, {0.6, 0.3, 1.2}, {0.9, -0.6, 1.2}};
  RoomModel room_;
  FingerprintMap map_;
};

// Gain, phase and timing of every frame are others the second time.
TEST_F(FingerprintMapTest, FindsThePointOfTheDeviceAgain) {
  for (const Vec3d& place : places_) {
    EXPECT_EQ(map_.nearest(frames_at(room_, place, {.seed = 2})), place);
  }
}

TEST_F(FingerprintMapTest, DoesWithOneAccessPointOfTheSurvey) {
  EXPECT_EQ(map_.nearest(only(frames_at(room_, places_[2], {.seed = 3}), 1)), places_[2]);
}

TEST_F(FingerprintMapTest, PrefersPointsOfTheSameAccessPoints) {
  FingerprintMap map(room_.grid, access_points_of(room_));
  const auto here = frames_at(room_, places_[0], {.seed = 4});
  ASSERT_TRUE(map.add(places_[0], here));
  ASSERT_TRUE(map.add(places_[1], only(here, 0)));
  EXPECT_EQ(map.nearest(only(here, 0)), places_[1]);
  EXPECT_EQ(map.nearest(here), places_[0]);
}

TEST_F(FingerprintMapTest, GivesNoResultWithoutFramesOrPoints) {
  EXPECT_FALSE(map_.nearest({}));
  FingerprintMap empty(room_.grid, access_points_of(room_));
  EXPECT_FALSE(empty.add(places_[0], {}));
  EXPECT_EQ(empty.size(), 0U);
  EXPECT_FALSE(empty.nearest(frames_at(room_, places_[0])));
}

}  // namespace
}  // namespace rayloc::fingerprint_map_test
