#include "engine/track/follow/target_filter.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <vector>

#include "tests/support/cloud_scene.h"

namespace rayloc::target_filter_test {
namespace {

using std::chrono::milliseconds;

// After one moment that this many access points received.
LocationEstimate stated(std::size_t access_points, double lone_exponent) {
  static const std::shared_ptr<const CloudRoom> kRoom = test::cloud_room(test::make_room());
  auto frames = test::frames_at(kRoom->localizer->room(), {-0.9, 0.5, 1.2}, {1, 20.0, 5U});
  frames.resize(access_points);  // one frame of each access point
  TrackOptions options;
  options.lone_exponent = lone_exponent;
  TargetFilter filter(kRoom->localizer, kRoom->space, options, Duration{}, {});
  const RoomObservation observation = kRoom->localizer->receive(frames);
  filter.advance(Timestamp(milliseconds(100)));
  EXPECT_TRUE(filter.weigh({observation, frames, milliseconds(100), 0.0, 0.0}));
  LocationEstimate location;
  filter.summarise({}, false, location);
  return location;
}

TEST(TargetFilter, ReportsABroaderDistributionWithOneAccessPoint) {
  const auto best = [](const LocationEstimate& location) {
    return location.hypotheses.empty() ? 0.0 : location.hypotheses.front().weight;
  };
  const LocationEstimate one = stated(1, 0.75);
  const LocationEstimate sharper = stated(1, 1.0);
  ASSERT_TRUE(one.position && sharper.position);
  EXPECT_EQ(*one.position, *sharper.position);
  EXPECT_GT(best(one), 0.0);
  EXPECT_LT(best(one), best(sharper));
  EXPECT_EQ(best(stated(2, 0.75)), best(stated(2, 1.0)));
}

}  // namespace
}  // namespace rayloc::target_filter_test
