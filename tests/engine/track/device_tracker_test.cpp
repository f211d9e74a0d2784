#include "engine/track/device_tracker.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/support/synthetic_room.h"

namespace rayloc {
namespace {

using std::chrono::milliseconds;

const MacAddress kDevice{{2, 0, 0, 0, 0, 1}};

// With fewer access points a snapshot is often ambiguous, which is what a tracker is for.
RoomModel room_of(std::size_t access_points) {
  RoomModel room = test::make_room();
  room.access_points.resize(access_points);
  return room;
}

std::shared_ptr<const Localizer> localizer(std::size_t access_points = 2) {
  static std::map<std::size_t, std::shared_ptr<const Localizer>> made;
  auto& one = made[access_points];
  if (one == nullptr) {
    one = std::make_shared<const Localizer>(*Localizer::create(
        std::make_shared<const RoomModel>(room_of(access_points)), LocalizerOptions{}));
  }
  return one;
}

// One frame per access point, `ms` after the start.
std::vector<CsiFrame> frames(const RoomModel& room, const Vec3d& position, int ms, double snr_db) {
  auto heard = test::frames_at(room, position, {1, snr_db, static_cast<unsigned>(ms + 1)});
  for (CsiFrame& frame : heard) {
    frame.time = Timestamp(milliseconds(ms));
  }
  return heard;
}

double error_of(const LocationEstimate& estimate, const Vec3d& truth) {
  return std::hypot(estimate.position->x - truth.x, estimate.position->y - truth.y);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Along a straight line at 0.5 m/s.
Vec3d walker(int ms) { return {-0.9 + 0.5e-3 * ms, 0.7 - 0.35e-3 * ms, 1.2}; }

struct Walk {
  std::vector<DeviceUpdate> updates;
  std::vector<double> snapshot_error;
  std::vector<double> filtered_error;
};

Walk walk(const Localizer& localizer, DeviceTracker& tracker) {
  Walk result;
  for (int ms = 0; ms <= 2000; ms += 50) {
    const auto heard = frames(localizer.room(), walker(ms), ms, 20.0);
    const std::size_t before = result.updates.size();
    tracker.hear(kDevice, heard, result.updates);
    EXPECT_EQ(result.updates.size(), before + 1) << ms;
    const LocationEstimate& filtered = result.updates.back().estimate.location;
    const LocationEstimate snapshot = localizer.locate(heard);
    if (ms >= 500 && snapshot.position) {  // a snapshot of one frame may not know
      EXPECT_TRUE(filtered.position) << ms;
      result.snapshot_error.push_back(error_of(snapshot, walker(ms)));
      result.filtered_error.push_back(error_of(filtered, walker(ms)));
    }
  }
  return result;
}

// The place that the whole room says is likeliest stays among those of the window.
TEST(DeviceTracker, WindowKeepsTheFirstHypothesisOfTheWholeRoom) {
  for (const std::size_t access_points : {std::size_t{1}, std::size_t{2}}) {
    DeviceTrackerOptions whole;
    whole.track.is_exhaustive = true;
    DeviceTracker exhaustive(localizer(access_points), whole);
    DeviceTracker tracker(localizer(access_points), {});
    const auto expected = walk(*localizer(access_points), exhaustive).updates;
    const auto found = walk(*localizer(access_points), tracker).updates;
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const LocationEstimate& all = expected[i].estimate.location;
      const LocationEstimate& part = found[i].estimate.location;
      ASSERT_EQ(all.position.has_value(), part.position.has_value()) << i;
      if (all.hypotheses.empty()) {
        continue;
      }
      const Vec3d& first = all.hypotheses.front().position;
      EXPECT_TRUE(std::any_of(part.hypotheses.begin(),
                              part.hypotheses.end(),
                              [&](const auto& one) {
                                return std::hypot(one.position.x - first.x,
                                                  one.position.y - first.y) < 0.15;
                              }))
          << access_points << ' ' << i;
    }
  }
}

TEST(DeviceTracker, FollowsAWalkBetterThanSnapshots) {
  DeviceTracker tracker(localizer(), {});
  const Walk result = walk(*localizer(), tracker);
  const auto mean = [](const std::vector<double>& errors) {
    double sum = 0.0;
    for (const double error : errors) {
      sum += error / static_cast<double>(errors.size());
    }
    return sum;
  };
  ASSERT_GT(result.snapshot_error.size(), 10U);
  EXPECT_LT(mean(result.filtered_error), 0.7 * mean(result.snapshot_error));
  EXPECT_LT(median(result.filtered_error), 0.3);
}

TEST(DeviceTracker, StatesTheSpeedOfAWalk) {
  DeviceTracker tracker(localizer(3), {});
  const Walk result = walk(*localizer(3), tracker);
  EXPECT_FALSE(result.updates.front().estimate.velocity);
  ASSERT_TRUE(result.updates.back().estimate.velocity);
  EXPECT_NEAR(result.updates.back().estimate.velocity->x, 0.5, 0.1);
  EXPECT_NEAR(result.updates.back().estimate.velocity->y, -0.35, 0.1);
  EXPECT_LT(result.updates.back().estimate.standing, 0.5);
}

// Later bursts through the same channel say nothing new.
TEST(DeviceTracker, RegionOfAStandingDeviceStaysHonest) {
  int places = 0;
  double first_accuracy = 0.0;
  double last_accuracy = 0.0;
  int outside = 0;  // of the region of 95 %
  for (const double x : {-1.2, -0.4, 0.4, 1.2}) {
    for (const double y : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      DeviceTracker tracker(localizer(), {});
      const Vec3d truth{x, y, 1.2};
      std::vector<DeviceUpdate> updates;
      for (int ms = 0; ms <= 1000; ms += 50) {
        tracker.hear(kDevice, frames(localizer()->room(), truth, ms, 30.0), updates);
      }
      const FilteredEstimate& first = updates.front().estimate;
      const FilteredEstimate& last = updates.back().estimate;
      ++places;
      first_accuracy += first.location.accuracy_m;
      last_accuracy += last.location.accuracy_m;
      outside += error_of(last.location, truth) > last.location.accuracy_m ? 1 : 0;
      EXPECT_GT(last.standing, 0.9);
    }
  }
  std::printf("of %d places %d outside; accuracy %.2f m, then %.2f m\n",
              places,
              outside,
              first_accuracy / places,
              last_accuracy / places);
  EXPECT_LT(last_accuracy, 1.05 * first_accuracy);
  EXPECT_LE(outside, 2);
}

// Cells are centimetres wide, and three access points know a place to millimetres: also of a device
// that stands, whose later bursts say nothing new.
TEST(DeviceTracker, KnowsThePlaceWithinACell) {
  RoomModel room = room_of(3);
  for (RoomAccessPoint& ap : room.access_points) {  // as good as what is simulated of it
    ap.error.plan_tolerance = 0.001;
    ap.error.diffuse = 0.005;
  }
  const auto exact = std::make_shared<const Localizer>(
      *Localizer::create(std::make_shared<const RoomModel>(std::move(room)), {}));
  const RoomGrid& grid = exact->grid();
  const Vec3d centre = grid.centre((grid.count_x / 3) * grid.count_y + grid.count_y / 2);
  for (const double side : {-0.4, 0.4}) {
    DeviceTracker tracker(exact, {});
    const Vec3d truth = centre + Vec3d{side * grid.step_x, -side * grid.step_y, 0.0};
    std::vector<DeviceUpdate> updates;
    for (int ms = 0; ms <= 1500; ms += 50) {
      tracker.hear(kDevice, frames(exact->room(), truth, ms, 40.0), updates);
    }
    const LocationEstimate& last = updates.back().estimate.location;
    ASSERT_TRUE(last.position);
    EXPECT_LT(error_of(last, truth), 0.2 * grid.step_x);
    EXPECT_LE(error_of(last, truth), last.accuracy_m);
  }
}

TEST(DeviceTracker, SameChannelHeardAgainIsNoMoreThanASnapshot) {
  DeviceTracker tracker(localizer(), {});
  std::vector<DeviceUpdate> updates;
  const Vec3d truth{-0.4, -0.5, 1.2};
  for (int ms = 0; ms <= 3000; ms += 50) {
    tracker.hear(kDevice, frames(localizer()->room(), truth, ms, 60.0), updates);
  }
  const LocationEstimate snapshot =
      localizer()->locate(frames(localizer()->room(), truth, 0, 60.0));
  EXPECT_GT(updates.back().estimate.location.accuracy_m, 0.5 * snapshot.accuracy_m);
}

TEST(DeviceTracker, GoesThroughTheLifeOfATrack) {
  DeviceTracker tracker(localizer(), {});
  std::vector<DeviceUpdate> updates;
  for (int ms = 0; ms <= 1000; ms += 50) {
    tracker.hear(kDevice, frames(localizer()->room(), {0.1, 0.2, 1.2}, ms, 30.0), updates);
  }
  tracker.advance(Timestamp(milliseconds(9000)), updates);
  std::vector<TrackState> states;
  std::vector<int> times;
  for (const DeviceUpdate& update : updates) {
    if (const auto& transition = update.estimate.transition) {
      EXPECT_EQ(transition->before.has_value(), !states.empty());
      EXPECT_TRUE(states.empty() || *transition->before == states.back());
      EXPECT_EQ(transition->after, update.estimate.state);
      EXPECT_FALSE(transition->reason.empty());
      states.push_back(transition->after);
      times.push_back(static_cast<int>(transition->time.time_since_epoch() / milliseconds(1)));
    }
  }
  EXPECT_EQ(states,
            (std::vector{TrackState::kTentative,
                         TrackState::kConfirmed,
                         TrackState::kCoasting,
                         TrackState::kLost}));
  EXPECT_EQ(times, (std::vector{0, 200, 1500, 6100}));
  EXPECT_EQ(tracker.size(), 0U);
}

TEST(DeviceTracker, CoastingGrowsTheRegionAndHearingEndsIt) {
  DeviceTracker tracker(localizer(3), {});
  std::vector<DeviceUpdate> updates;
  for (int ms = 0; ms <= 1000; ms += 50) {
    tracker.hear(kDevice, frames(localizer(3)->room(), walker(ms), ms, 30.0), updates);
  }
  const std::size_t heard = updates.size();
  tracker.advance(Timestamp(milliseconds(2600)), updates);
  ASSERT_GT(updates.size(), heard + 5);
  for (std::size_t i = heard; i < updates.size(); ++i) {
    const FilteredEstimate& estimate = updates[i].estimate;
    EXPECT_TRUE(estimate.predicted);
    EXPECT_FALSE(estimate.velocity);
    EXPECT_EQ(estimate.location.frames_used, 0U);
    if (estimate.location.position) {
      EXPECT_GT(estimate.location.accuracy_m, updates[heard - 1].estimate.location.accuracy_m);
      // It is about the position, which may go over to another hill.
      EXPECT_TRUE(i == heard || estimate.location.covariance[0] >=
                                    0.9 * updates[i - 1].estimate.location.covariance[0]);
    }
  }
  updates.clear();
  for (int ms = 2700; ms <= 3000; ms += 50) {
    tracker.hear(kDevice, frames(localizer(3)->room(), walker(1500), ms, 30.0), updates);
  }
  ASSERT_FALSE(updates.empty());
  EXPECT_EQ(updates.back().estimate.state, TrackState::kConfirmed);
  EXPECT_LT(error_of(updates.back().estimate.location, walker(1500)), 0.1);
}

TEST(DeviceTracker, TentativeTrackIsForgottenSoon) {
  DeviceTracker tracker(localizer(), {});
  std::vector<DeviceUpdate> updates;
  tracker.hear(kDevice, frames(localizer()->room(), {0.1, 0.2, 1.2}, 0, 30.0), updates);
  EXPECT_EQ(tracker.size(), 1U);
  tracker.advance(Timestamp(milliseconds(1200)), updates);
  EXPECT_EQ(tracker.size(), 0U);
  EXPECT_EQ(updates.back().estimate.state, TrackState::kLost);
}

TEST(DeviceTracker, SilenceIsStatedTheSameHoweverOftenTimeAdvances) {
  std::vector<std::vector<DeviceUpdate>> stated;
  for (const int step : {70, 2000}) {
    DeviceTracker tracker(localizer(), {});
    std::vector<DeviceUpdate> updates;
    for (int ms = 0; ms <= 300; ms += 50) {
      tracker.hear(kDevice, frames(localizer()->room(), walker(ms), ms, 30.0), updates);
    }
    for (int ms = 300; ms <= 2300; ms += step) {
      tracker.advance(Timestamp(milliseconds(ms)), updates);
    }
    tracker.hear(kDevice, frames(localizer()->room(), walker(2500), 2500, 30.0), updates);
    stated.push_back(std::move(updates));
  }
  ASSERT_EQ(stated[0].size(), stated[1].size());
  for (std::size_t i = 0; i < stated[0].size(); ++i) {
    const LocationEstimate& a = stated[0][i].estimate.location;
    const LocationEstimate& b = stated[1][i].estimate.location;
    EXPECT_EQ(a.time, b.time);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.accuracy_m, b.accuracy_m);
  }
}

TEST(DeviceTracker, RefusesFramesThatAreNotLater) {
  DeviceTracker tracker(localizer(), {});
  std::vector<DeviceUpdate> updates;
  for (const int ms : {0, 100, 100, 50}) {
    tracker.hear(kDevice, frames(localizer()->room(), {0.1, 0.2, 1.2}, ms, 30.0), updates);
  }
  EXPECT_EQ(updates.size(), 2U);
  EXPECT_EQ(tracker.counters().moments, 4U);
  EXPECT_EQ(tracker.counters().used, 2U);
  EXPECT_EQ(tracker.counters().out_of_order, 2U);
}

TEST(DeviceTracker, BoundsTheNumberOfTracks) {
  DeviceTrackerOptions options;
  options.max_tracks = 1;
  DeviceTracker tracker(localizer(), options);
  std::vector<DeviceUpdate> updates;
  const auto heard = frames(localizer()->room(), {0.1, 0.2, 1.2}, 0, 30.0);
  tracker.hear(kDevice, heard, updates);
  tracker.hear(MacAddress{{2, 0, 0, 0, 0, 2}}, heard, updates);
  EXPECT_EQ(updates.size(), 1U);
  EXPECT_EQ(tracker.size(), 1U);
  EXPECT_EQ(tracker.counters().refused, 1U);
}

TEST(Field, DeviceTrackerFollowsKnownDevicesThroughAFloodOfOthers) {
  const MacAddress known{{2, 0, 0, 0, 0, 9}};
  DeviceTrackerOptions options;
  options.max_tracks = 1;
  options.always = {known};
  DeviceTracker tracker(localizer(), options);
  std::vector<DeviceUpdate> updates;
  for (const int ms : {0, 100, 200, 300, 400}) {
    const auto heard = frames(localizer()->room(), {0.1, 0.2, 1.2}, ms, 30.0);
    if (ms == 0) {
      tracker.hear(MacAddress{{2, 0, 0, 0, 0, 2}}, heard, updates);
    }
    tracker.hear(MacAddress{{2, 0, 0, 0, 0, 3}}, heard, updates);
    tracker.hear(known, heard, updates);
    // Heard once it may be anybody.
    EXPECT_EQ(tracker.follows(known), ms == 400);
  }
  EXPECT_EQ(tracker.size(), 2U);
  EXPECT_EQ(tracker.counters().refused, 5U);
  EXPECT_FALSE(tracker.follows(MacAddress{{2, 0, 0, 0, 0, 2}}));
  EXPECT_FALSE(tracker.follows(MacAddress{{2, 0, 0, 0, 0, 3}}));
}

TEST(DeviceTracker, IsTheSameOnOneThreadAndOnTwo) {
  std::vector<std::vector<DeviceUpdate>> runs;
  for (const std::size_t threads : {1U, 2U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    DeviceTracker tracker(localizer(), {});
    runs.push_back(walk(*localizer(), tracker).updates);
  }
  ASSERT_EQ(runs[0].size(), runs[1].size());
  for (std::size_t i = 0; i < runs[0].size(); ++i) {
    const LocationEstimate& a = runs[0][i].estimate.location;
    const LocationEstimate& b = runs[1][i].estimate.location;
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.covariance, b.covariance);
    EXPECT_EQ(a.accuracy_m, b.accuracy_m);
  }
}

}  // namespace
}  // namespace rayloc
