#include "engine/track/person_tracker.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/person_in_room.h"

namespace rayloc {
namespace {

// Three frames of each access point from this time on.
std::vector<CsiFrame> moment(const RoomModel& room,
                             const std::vector<TargetPosition>& places,
                             double seconds) {
  auto frames = test::frames_past(room,
                                  places,
                                  PersonModel{}.body,
                                  {.count = 3, .seed = static_cast<unsigned>(1000.0 * seconds)});
  for (CsiFrame& frame : frames) {
    frame.time += from_seconds(seconds);
  }
  std::stable_sort(frames.begin(), frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
    return a.time < b.time;
  });
  return frames;
}

TEST(PersonTracker, FollowsAWalkAndLosesWhoHasLeft) {
  const auto room = std::make_shared<const RoomModel>(test::make_room());
  const auto localizer = std::make_shared<const PersonLocalizer>(
      *PersonLocalizer::create(room, test::learn_reference(*room), {}));
  PersonTracker tracker(localizer, {});
  std::vector<PersonUpdate> updates;

  // Nobody yet.
  for (int i = 0; i < 5; ++i) {
    tracker.hear(moment(*room, {}, 0.1 * i), updates);
  }
  EXPECT_TRUE(updates.empty());

  int near = 0;
  for (int i = 0; i < 40; ++i) {
    const double t = 1.0 + 0.1 * i;
    const TargetPosition truth{-0.8 + 0.04 * i, 0.3 - 0.01 * i};
    updates.clear();
    tracker.hear(moment(*room, {truth}, t), updates);
    ASSERT_EQ(updates.size(), 1U);
    EXPECT_EQ(updates[0].track, 1U);
    const auto& location = updates[0].estimate.location;
    if (i >= 10 && location.position) {
      near +=
          std::hypot(location.position->x - truth.x, location.position->y - truth.y) < 0.1 ? 1 : 0;
    }
  }
  EXPECT_GE(near, 28);
  EXPECT_EQ(updates[0].estimate.state, TrackState::kConfirmed);

  std::vector<TrackState> after;
  for (int i = 0; i < 60; ++i) {
    updates.clear();
    tracker.hear(moment(*room, {}, 5.0 + 0.1 * i), updates);
    for (const PersonUpdate& update : updates) {
      if (update.estimate.transition) {
        after.push_back(update.estimate.transition->after);
      }
    }
  }
  EXPECT_EQ(after, (std::vector<TrackState>{TrackState::kCoasting, TrackState::kLost}));

  // Who comes next is another track.
  updates.clear();
  for (int i = 0; i < 5; ++i) {
    tracker.hear(moment(*room, {{0.2, 0.2}}, 20.0 + 0.1 * i), updates);
  }
  ASSERT_FALSE(updates.empty());
  EXPECT_EQ(updates.back().track, 2U);
}

}  // namespace
}  // namespace rayloc
