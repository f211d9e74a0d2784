#include "engine/track/device_tracker.h"

#include <gtest/gtest.h>
#include <malloc.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "tests/support/synthetic_room.h"

namespace rayloc::device_tracker_test {
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
  auto received = test::frames_at(room, position, {1, snr_db, static_cast<unsigned>(ms + 1)});
  for (CsiFrame& frame : received) {
    frame.time = Timestamp(milliseconds(ms));
  }
  return received;
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
    const auto received = frames(localizer.room(), walker(ms), ms, 20.0);
    const std::size_t before = result.updates.size();
    tracker.receive(kDevice, received, result.updates);
    EXPECT_EQ(result.updates.size(), before + 1) << ms;
    const LocationEstimate& filtered = result.updates.back().estimate.location;
    const LocationEstimate snapshot = localizer.locate(received);
    if (ms >= 500 && snapshot.position) {  // a snapshot of one frame may lack a position
      EXPECT_TRUE(filtered.position) << ms;
      result.snapshot_error.push_back(error_of(snapshot, walker(ms)));
      result.filtered_error.push_back(error_of(filtered, walker(ms)));
    }
  }
  return result;
}

std::vector<double> numbers_of(const std::vector<DeviceUpdate>& updates) {
  std::vector<double> numbers;
  for (const DeviceUpdate& update : updates) {
    const LocationEstimate& location = update.estimate.location;
    numbers.push_back(static_cast<double>(location.time.time_since_epoch().count()));
    if (location.position) {
      numbers.insert(numbers.end(), {location.position->x, location.position->y});
    }
    for (const auto& hypothesis : location.hypotheses) {
      numbers.insert(numbers.end(), {hypothesis.position.x, hypothesis.weight});
    }
  }
  return numbers;
}

// One evaluation of the whole room is enough to leave a wrong place: it then counts for all the
// time since the one before it.
TEST(DeviceTracker, LeavesAWrongPlaceByEvaluatingTheWholeRoom) {
  constexpr int kJump = 1500;   // [ms], when it is followed
  constexpr int kLater = 6500;  // [ms], more than from one look to the next
  DeviceTracker tracker(localizer(3), DeviceTrackerOptions{});
  std::vector<DeviceUpdate> updates;
  const auto place = [](int ms) {  // to and fro, so that the channel changes
    const double swing = 0.15 * std::sin(2e-3 * ms);
    return ms < kJump ? Vec3d{-1.0 + swing, -0.8, 1.2} : Vec3d{1.0 + swing, 0.7, 1.2};
  };
  double before = 0.0;
  for (int ms = 0; ms <= kJump + kLater; ms += 100) {
    tracker.receive(kDevice, frames(localizer(3)->room(), place(ms), ms, 20.0), updates);
    const LocationEstimate& location = updates.back().estimate.location;
    if (ms == kJump - 100) {
      ASSERT_TRUE(location.position);
      before = error_of(location, place(ms));
    }
  }
  EXPECT_LT(before, 0.1);
  const LocationEstimate& after = updates.back().estimate.location;
  ASSERT_TRUE(after.position);
  EXPECT_LT(error_of(after, place(kJump + kLater)), 0.3);
}

// A track that one access point leads astray is led back by the first burst of those that join,
// before the next evaluation of the whole room is due.
TEST(DeviceTracker, EvaluatesTheWholeRoomWhenAccessPointsJoin) {
  constexpr int kJoin = 1700;  // [ms], before the next look is due
  // The last one is at rest: its channel is always the same.
  const std::vector<std::pair<Vec3d, double>> swings = {
      {{-0.6, -0.3, 1.2}, 0.05}, {{0.0, 0.9, 1.2}, 0.05}, {{-0.9, -0.3, 1.2}, 0.0}};
  for (const auto& [middle, swing] : swings) {
    DeviceTracker tracker(localizer(3), DeviceTrackerOptions{});
    std::vector<DeviceUpdate> updates;
    for (int ms = 0; ms <= kJoin; ms += 100) {
      const Vec3d place = middle + Vec3d{swing * std::sin(2e-3 * ms), 0.0, 0.0};
      auto received = frames(localizer(3)->room(), place, ms, 20.0);
      received.resize(ms < kJoin ? 1 : 3);
      tracker.receive(kDevice, received, updates);
      const LocationEstimate& location = updates.back().estimate.location;
      const double error = location.position ? error_of(location, place) : 1.0;
      EXPECT_TRUE(ms != kJoin - 100 || error > 0.5) << "one is not astray: " << error;
      EXPECT_TRUE(ms != kJoin || error < 0.2) << error;
    }
  }
}

// Beside what all tracks of a room share: 64 KiB, also while a device may be in many places.
TEST(DeviceTracker, ATrackTakesLittleMemory) {
  if (mallinfo2().uordblks == 0) {
    GTEST_SKIP() << "a sanitizer's allocator does not say what it has given out";
  }
  constexpr int kDevices = 20;
  for (const std::size_t access_points : {std::size_t{1}, std::size_t{3}}) {
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    std::optional<DeviceTracker> tracker(
        std::in_place, localizer(access_points), DeviceTrackerOptions());
    for (int device = 0; device < kDevices; ++device) {
      std::vector<DeviceUpdate> updates;
      const MacAddress address{{2, 0, 0, 0, 1, static_cast<std::uint8_t>(device)}};
      for (int ms = 0; ms <= 200; ms += 50) {
        const RoomModel& room = localizer(access_points)->room();
        tracker->receive(address, frames(room, walker(80 * device + ms), ms, 20.0), updates);
      }
    }
    ASSERT_EQ(tracker->size(), static_cast<std::size_t>(kDevices));
    const std::size_t with_tracks = mallinfo2().uordblks;
    tracker.reset();
    const std::size_t of_tracks = with_tracks - mallinfo2().uordblks;
    std::printf("%zu access points: %zu KiB a track\n", access_points, of_tracks / kDevices / 1024);
    EXPECT_LE(of_tracks / kDevices, 64U * 1024U) << access_points;
    EXPECT_GT(of_tracks / kDevices, 1024U) << "or it was not measured";
  }
}

// The results of a device depend on none of the others: the same numbers whether bursts come
// together, one after the other or in reverse order, and on one thread.
TEST(DeviceTracker, GivesTheSameResultForAnyOrderOfDevices) {
  constexpr int kDevices = 4;
  enum class Mode { kTogether, kInOrder, kBackwards, kSerial };
  std::map<Mode, std::map<MacAddress, std::vector<double>>> estimates;
  for (const Mode mode : {Mode::kTogether, Mode::kInOrder, Mode::kBackwards, Mode::kSerial}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    mode == Mode::kSerial ? 1 : 4);
    DeviceTracker tracker(localizer(1), {});
    for (int ms = 0; ms <= 400; ms += 50) {
      std::vector<std::vector<CsiFrame>> received;
      received.reserve(kDevices);
      for (int device = 0; device < kDevices; ++device) {
        received.push_back(frames(localizer(1)->room(), walker(500 * device + ms), ms, 25.0));
      }
      std::vector<DeviceBurst> bursts;
      bursts.reserve(kDevices);
      for (int device = 0; device < kDevices; ++device) {
        bursts.push_back({{{2, 0, 0, 0, 0, static_cast<std::uint8_t>(device)}},
                          received[static_cast<std::size_t>(device)]});
      }
      if (mode == Mode::kBackwards) {
        std::reverse(bursts.begin(), bursts.end());
      }
      const std::size_t at_once = mode == Mode::kTogether || mode == Mode::kSerial ? kDevices : 1;
      for (std::size_t i = 0; i < bursts.size(); i += at_once) {
        for (const auto& updates : tracker.receive(std::span(bursts).subspan(i, at_once))) {
          ASSERT_FALSE(updates.empty());
          auto& numbers = estimates[mode][updates.front().device];
          const auto more = numbers_of(updates);
          numbers.insert(numbers.end(), more.begin(), more.end());
        }
      }
    }
  }
  EXPECT_EQ(estimates[Mode::kTogether].size(), static_cast<std::size_t>(kDevices));
  for (const Mode mode : {Mode::kInOrder, Mode::kBackwards, Mode::kSerial}) {
    EXPECT_EQ(estimates[mode], estimates[Mode::kTogether]) << static_cast<int>(mode);
  }
}

// As after a change of the chains' phases: the track goes on, and the device may be anywhere.
TEST(DeviceTracker, ForgetsPlacesAndFollowsOn) {
  DeviceTracker tracker(localizer(3), {});
  std::vector<DeviceUpdate> updates;
  const auto receive = [&](const Vec3d& place, int ms, const FrameFault& fault = {}) {
    tracker.receive(
        kDevice, frames(localizer(3)->room(), place, ms, 30.0), updates, std::nullopt, fault);
    return updates.back().estimate;
  };
  const Vec3d first{-0.9, 0.7, 1.2};
  const Vec3d second{1.0, -0.7, 1.2};
  for (int ms = 0; ms < 1000; ms += 100) {
    receive(first, ms);
  }
  ASSERT_TRUE(updates.back().estimate.location.position);
  EXPECT_LT(error_of(updates.back().estimate.location, first), 0.15);
  // The same with a burst that may be wrong: no hypothesis may exceed the rest of the probability.
  const FilteredEstimate suspect = receive(first, 1000, {0.4});
  EXPECT_GE(suspect.location.residual_probability, 0.4);
  ASSERT_FALSE(suspect.location.hypotheses.empty());
  EXPECT_LE(suspect.location.hypotheses.front().weight, 0.6);
  tracker.forget_places();
  EXPECT_TRUE(tracker.follows(kDevice));
  const FilteredEstimate next = receive(second, 1100);
  EXPECT_EQ(next.state, TrackState::kConfirmed);
  ASSERT_TRUE(next.location.position);
  EXPECT_LT(error_of(next.location, second), 0.15);
  EXPECT_EQ(tracker.counters().begun, 1U);
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
  EXPECT_LT(result.updates.back().estimate.stationary, 0.5);
}

// Cells are centimetres wide, and three access points resolve millimetres: also of a device at
// rest, whose later bursts carry no new information.
TEST(DeviceTracker, LocatesWithinACell) {
  RoomModel room = room_of(3);
  for (RoomAccessPoint& ap : room.access_points) {  // as good as what is simulated of it
    ap.error.plan_tolerance = 0.001;
    ap.error.diffuse = 0.005;
  }
  const auto exact = std::make_shared<const Localizer>(
      *Localizer::create(std::make_shared<const RoomModel>(std::move(room)), {}));
  const Grid& grid = exact->grid();
  const Vec3d centre = grid.centre((grid.count_x / 3) * grid.count_y + grid.count_y / 2);
  for (const double side : {-0.4, 0.4}) {
    DeviceTracker tracker(exact, {});
    const Vec3d truth = centre + Vec3d{side * grid.step_x, -side * grid.step_y, 0.0};
    std::vector<DeviceUpdate> updates;
    for (int ms = 0; ms <= 1500; ms += 50) {
      tracker.receive(kDevice, frames(exact->room(), truth, ms, 40.0), updates);
    }
    const LocationEstimate& last = updates.back().estimate.location;
    ASSERT_TRUE(last.position);
    EXPECT_LT(error_of(last, truth), 0.2 * grid.step_x);
    EXPECT_LE(error_of(last, truth), last.accuracy_m);
  }
}

TEST(DeviceTracker, GoesThroughTheLifeOfATrack) {
  DeviceTracker tracker(localizer(), {});
  std::vector<DeviceUpdate> updates;
  for (int ms = 0; ms <= 1000; ms += 50) {
    tracker.receive(kDevice, frames(localizer()->room(), {0.1, 0.2, 1.2}, ms, 30.0), updates);
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

TEST(DeviceTracker, CoastingGrowsTheRegionAndReceptionEndsIt) {
  DeviceTracker tracker(localizer(3), {});
  std::vector<DeviceUpdate> updates;
  for (int ms = 0; ms <= 1000; ms += 50) {
    tracker.receive(kDevice, frames(localizer(3)->room(), walker(ms), ms, 30.0), updates);
  }
  const std::size_t received = updates.size();
  tracker.advance(Timestamp(milliseconds(2600)), updates);
  ASSERT_GT(updates.size(), received + 5);
  for (std::size_t i = received; i < updates.size(); ++i) {
    const FilteredEstimate& estimate = updates[i].estimate;
    EXPECT_TRUE(estimate.predicted);
    EXPECT_FALSE(estimate.velocity);
    EXPECT_EQ(estimate.location.frames_used, 0U);
    if (estimate.location.position) {
      EXPECT_GT(estimate.location.accuracy_m, updates[received - 1].estimate.location.accuracy_m);
      // It is about the position, which may go over to another hill.
      EXPECT_TRUE(i == received || estimate.location.covariance[0] >=
                                       0.9 * updates[i - 1].estimate.location.covariance[0]);
    }
  }
  updates.clear();
  for (int ms = 2700; ms <= 3000; ms += 50) {
    tracker.receive(kDevice, frames(localizer(3)->room(), walker(1500), ms, 30.0), updates);
  }
  ASSERT_FALSE(updates.empty());
  EXPECT_EQ(updates.back().estimate.state, TrackState::kConfirmed);
  EXPECT_LT(error_of(updates.back().estimate.location, walker(1500)), 0.1);
}

TEST(DeviceTracker, TentativeTrackIsForgottenSoon) {
  DeviceTracker tracker(localizer(), {});
  std::vector<DeviceUpdate> updates;
  tracker.receive(kDevice, frames(localizer()->room(), {0.1, 0.2, 1.2}, 0, 30.0), updates);
  EXPECT_EQ(tracker.size(), 1U);
  tracker.advance(Timestamp(milliseconds(1200)), updates);
  EXPECT_EQ(tracker.size(), 0U);
  EXPECT_EQ(updates.back().estimate.state, TrackState::kLost);
}

TEST(DeviceTracker, ADeviceWhoseFramesWaitIsNotSilent) {
  DeviceTracker tracker(localizer(), {});
  std::vector<DeviceUpdate> updates;
  tracker.receive(kDevice, frames(localizer()->room(), {0.1, 0.2, 1.2}, 0, 30.0), updates);
  const MacAddress other{{2, 0, 0, 0, 0, 2}};
  tracker.receive(other, frames(localizer()->room(), {0.1, 0.2, 1.2}, 0, 30.0), updates);
  updates.clear();
  tracker.advance(Timestamp(milliseconds(9000)), updates, [](const MacAddress& device) {
    return device == kDevice;
  });
  EXPECT_TRUE(tracker.has(kDevice));
  EXPECT_FALSE(tracker.has(other));
  for (const DeviceUpdate& update : updates) {
    EXPECT_EQ(update.device, other);
  }
  // It has been received all the time, although nothing was processed for long.
  updates.clear();
  const Timestamp since{milliseconds(200)};
  tracker.receive(
      kDevice, frames(localizer()->room(), {0.1, 0.2, 1.2}, 9000, 30.0), updates, since);
  ASSERT_EQ(updates.size(), 1U);
  EXPECT_FALSE(updates[0].estimate.transition) << "the track continues";
  EXPECT_EQ(tracker.counters().begun, 2U);
}

TEST(DeviceTracker, SilenceIsStatedTheSameHoweverOftenTimeAdvances) {
  std::vector<std::vector<DeviceUpdate>> stated;
  for (const int step : {70, 2000}) {
    DeviceTracker tracker(localizer(), {});
    std::vector<DeviceUpdate> updates;
    for (int ms = 0; ms <= 300; ms += 50) {
      tracker.receive(kDevice, frames(localizer()->room(), walker(ms), ms, 30.0), updates);
    }
    for (int ms = 300; ms <= 2300; ms += step) {
      tracker.advance(Timestamp(milliseconds(ms)), updates);
    }
    tracker.receive(kDevice, frames(localizer()->room(), walker(2500), 2500, 30.0), updates);
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
    tracker.receive(kDevice, frames(localizer()->room(), {0.1, 0.2, 1.2}, ms, 30.0), updates);
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
  const auto received = frames(localizer()->room(), {0.1, 0.2, 1.2}, 0, 30.0);
  tracker.receive(kDevice, received, updates);
  tracker.receive(MacAddress{{2, 0, 0, 0, 0, 2}}, received, updates);
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
    const auto received = frames(localizer()->room(), {0.1, 0.2, 1.2}, ms, 30.0);
    if (ms == 0) {
      tracker.receive(MacAddress{{2, 0, 0, 0, 0, 2}}, received, updates);
    }
    tracker.receive(MacAddress{{2, 0, 0, 0, 0, 3}}, received, updates);
    tracker.receive(known, received, updates);
    // A single burst may come from any sender.
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
}  // namespace rayloc::device_tracker_test
