#include "engine/track/follow/cloud_follower.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "tests/support/synthetic_room.h"

namespace rayloc::cloud_follower_test {
namespace {

using std::chrono::milliseconds;

constexpr int kStep = 100;  // [ms], between two moments

std::shared_ptr<const Localizer> localizer() {
  static const auto kMade = std::make_shared<const Localizer>(
      *Localizer::create(std::make_shared<const RoomModel>(test::make_room()), {}));
  return kMade;
}

std::shared_ptr<const CloudRoom> room() {
  static const auto kMade = make_cloud_room(
      localizer(), std::make_shared<const FreeSpace>(make_free_space(*localizer())));
  return kMade;
}

// To and fro, so that each moment is new.
Vec3d truth(int ms) { return {-0.9 + 0.1 * std::sin(2e-3 * ms), 0.5, 1.2}; }

std::vector<CsiFrame> frames_at(int ms) {
  auto frames =
      test::frames_at(localizer()->room(), truth(ms), {1, 20.0, static_cast<unsigned>(ms + 1)});
  for (CsiFrame& frame : frames) {
    frame.time = Timestamp(milliseconds(ms));
  }
  return frames;
}

// A cloud about a place, and all access points in the moments before.
CloudFollower follower_at(const Vec3d& middle, const TrackOptions& options) {
  PlaceCloud cloud;
  NormalDraws draws(4);
  for (int i = 0; i < 1500; ++i) {
    CloudPlace place;
    place.x = static_cast<float>(middle.x) + 0.05F * draws.normal();
    place.y = static_cast<float>(middle.y) + 0.05F * draws.normal();
    place.z = static_cast<float>(middle.z);
    place.is_resting = true;
    cloud.add(place, 0.0F);
  }
  WeighedAccessPoints weighed;
  weighed.note(localizer()->receive(frames_at(0)), Timestamp());
  return {room(),
          CloudFilter(room(), options.cloud, 5, std::move(cloud), Timestamp()),
          options,
          Duration{},
          std::move(weighed)};
}

// [ms], when the follower gave the target back to the grid; empty: it did not.
std::optional<int> given_back(CloudFollower& follower, int until_ms) {
  for (int ms = kStep; ms <= until_ms; ms += kStep) {
    const auto frames = frames_at(ms);
    const RoomObservation observation = localizer()->receive(frames);
    follower.advance(Timestamp(milliseconds(ms)));
    if (!follower.weigh({observation, frames, milliseconds(kStep), std::nullopt, 0.0})) {
      return ms;
    }
    LocationEstimate location;
    follower.summarise({}, location);
    if (!follower.settle()) {
      return ms;
    }
  }
  return std::nullopt;
}

TEST(CloudFollower, KeepsATargetAtItsPlace) {
  const TrackOptions options;
  CloudFollower follower = follower_at(truth(0), options);
  EXPECT_FALSE(given_back(follower, 9000));
}

// The other rules are off, and the places do not walk: the evaluations of the whole room alone find
// the better place.
TEST(CloudFollower, GivesBackATargetThatIsAtABetterPlace) {
  TrackOptions options;
  options.hand_over.max_away = 1.0;
  options.hand_over.max_outside = 1.0;
  options.hand_over.return_cells = 0.0;
  options.cloud.motion.switching_rate = 0.0;
  CloudFollower follower = follower_at({0.8, -0.5, 1.2}, options);
  const auto when = given_back(follower, 9000);
  ASSERT_TRUE(when);
  EXPECT_GT(*when, 1000) << "one evaluation is not enough";
  EXPECT_GE(follower.spread(), options.hand_over.rival_spread);
}

TEST(CloudFollower, GivesBackATargetWhenAnAccessPointJoins) {
  const TrackOptions options;
  CloudFollower follower = follower_at(truth(0), options);
  const auto frames = frames_at(6000);  // no access point was received for seconds
  const RoomObservation observation = localizer()->receive(frames);
  follower.advance(Timestamp(milliseconds(6000)));
  EXPECT_FALSE(follower.weigh({observation, frames, milliseconds(6000), 1.0, 0.0}));
  EXPECT_LT(follower.spread(), options.hand_over.rival_spread);
}

// A channel that has had its weight is not compared again, and its access points remain.
TEST(CloudFollower, AMomentThatIsNotNewChangesNoPlace) {
  const TrackOptions options;
  CloudFollower follower = follower_at(truth(0), options);
  const std::vector<float> before = follower.cloud().weights();
  const auto frames = frames_at(0);
  const RoomObservation observation = localizer()->receive(frames);
  const auto credit =
      follower.weigh({observation, frames, milliseconds(kStep), std::nullopt, 0.99});
  ASSERT_TRUE(credit);
  EXPECT_EQ(*credit, 0.99);
  EXPECT_EQ(follower.cloud().weights(), before);
  EXPECT_FALSE(follower.is_due(std::span(frames).first(1)));
}

}  // namespace
}  // namespace rayloc::cloud_follower_test
