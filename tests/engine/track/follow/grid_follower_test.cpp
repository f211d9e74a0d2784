#include "engine/track/follow/grid_follower.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <vector>

#include "tests/support/cloud_scene.h"

namespace rayloc::grid_follower_test {
namespace {

using std::chrono::milliseconds;

const CloudRoom& room() {
  static const std::shared_ptr<const CloudRoom> kRoom = test::cloud_room(test::make_room());
  return *kRoom;
}

std::vector<CsiFrame> frames_at(int ms) {
  auto frames = test::frames_at(
      room().localizer->room(), {-0.9, 0.5, 1.2}, {1, 20.0, static_cast<unsigned>(ms + 1)});
  for (CsiFrame& frame : frames) {
    frame.time = Timestamp(milliseconds(ms));
  }
  return frames;
}

// A device at rest in a cloud, whose channel has had its weight.
TEST(GridFollower, TheFirstMomentAfterACloudIsCompared) {
  PlaceCloud cloud;
  CloudPlace place;
  place.x = 0.8F;
  place.y = -0.5F;
  place.z = 1.2F;
  place.is_resting = true;
  cloud.add(place, 0.0F);
  const auto frames = frames_at(100);
  const RoomObservation observation = room().localizer->receive(frames);
  WeighedAccessPoints weighed;
  weighed.note(observation, Timestamp());
  GridFollower follower(room().localizer, room().space, TrackOptions{}, Duration{});
  follower.continue_from(cloud, 0.5, weighed, Timestamp());
  follower.advance(Timestamp(milliseconds(100)));
  const auto first = follower.weigh({observation, frames, milliseconds(100), 0.0, 0.99});
  ASSERT_TRUE(first);
  EXPECT_FALSE(follower.within().empty());
  EXPECT_EQ(*first, 1.0);
}

// Its evidence may separate places that the others find alike.
TEST(GridFollower, AnAccessPointJoinsAfterThePlaceWasForgotten) {
  GridFollower follower(room().localizer, room().space, TrackOptions{}, Duration{});
  const auto weigh = [&](int ms, std::size_t access_points, double credit) {
    auto frames = frames_at(ms);
    frames.resize(access_points);  // one an access point
    const RoomObservation observation = room().localizer->receive(frames);
    follower.advance(Timestamp(milliseconds(ms)));
    return follower.weigh({observation, frames, milliseconds(100), 0.0, credit}).value_or(-1.0);
  };
  EXPECT_EQ(weigh(100, 2, 0.0), 1.0);
  follower.forget_place();
  EXPECT_EQ(weigh(200, 1, 0.0), 1.0);
  EXPECT_EQ(weigh(300, 1, 0.999), 0.999);
  EXPECT_EQ(weigh(400, 2, 0.999), 1.0);
}

}  // namespace
}  // namespace rayloc::grid_follower_test
