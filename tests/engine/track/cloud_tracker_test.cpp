// Devices that clouds of places follow: the properties that device_tracker_test demands of the
// grid.
#include <gtest/gtest.h>
#include <malloc.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "engine/track/device_tracker.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::cloud_tracker_test {
namespace {

using std::chrono::milliseconds;

const MacAddress kDevice{{2, 0, 0, 0, 0, 1}};

RoomModel room_of(std::size_t access_points, double height_sigma) {
  RoomModel room = test::make_room();
  room.access_points.resize(access_points);
  room.device.height_sigma = height_sigma;
  return room;
}

std::shared_ptr<const Localizer> new_localizer(std::size_t access_points,
                                               double height_sigma = 0.0) {
  return std::make_shared<const Localizer>(*Localizer::create(
      std::make_shared<const RoomModel>(room_of(access_points, height_sigma)), {}));
}

std::shared_ptr<const Localizer> localizer(std::size_t access_points) {
  static std::map<std::size_t, std::shared_ptr<const Localizer>> made;
  auto& one = made[access_points];
  if (one == nullptr) {
    one = new_localizer(access_points);
  }
  return one;
}

DeviceTrackerOptions clouds() {
  DeviceTrackerOptions options;
  options.track.uses_cloud = true;
  options.track.hand_over.acquire_for = milliseconds(300);
  return options;
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
  return estimate.position
             ? std::hypot(estimate.position->x - truth.x, estimate.position->y - truth.y)
             : 10.0;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Along a straight line at 0.6 m/s.
Vec3d walker(int ms) { return {-0.9 + 0.5e-3 * ms, 0.7 - 0.35e-3 * ms, 1.2}; }

void receive_walk(const RoomModel& room,
                  DeviceTracker& tracker,
                  int until_ms,
                  std::vector<DeviceUpdate>& updates) {
  for (int ms = 0; ms <= until_ms; ms += 50) {
    const std::size_t before = updates.size();
    tracker.receive(kDevice, frames(room, walker(ms), ms, 20.0), updates);
    EXPECT_EQ(updates.size(), before + 1) << ms;
  }
}

// Every field of the estimates.
std::vector<double> numbers_of(const std::vector<DeviceUpdate>& updates) {
  std::vector<double> numbers;
  const auto add = [&](const auto& values) {
    for (const double value : values) {
      numbers.push_back(value);
    }
  };
  const auto add_vector = [&](const Vec3d& v) { add(std::vector<double>{v.x, v.y, v.z}); };
  const auto add_time = [&](Timestamp time) {
    numbers.push_back(static_cast<double>(time.time_since_epoch().count()));
  };
  for (const DeviceUpdate& update : updates) {
    const FilteredEstimate& estimate = update.estimate;
    const LocationEstimate& location = estimate.location;
    add_time(location.time);
    add_time(location.capture_start);
    add_time(location.capture_end);
    add_vector(location.position.value_or(Vec3d{-9.0, -9.0, -9.0}));
    add_vector(estimate.velocity.value_or(Vec3d{-9.0, -9.0, -9.0}));
    add(location.covariance);
    for (const Hypothesis& one : location.hypotheses) {
      add_vector(one.position);
      add(one.covariance);
      numbers.push_back(one.weight);
    }
    add(std::vector<double>{location.accuracy_m,
                            location.residual_probability,
                            location.loss,
                            location.snr_db,
                            estimate.stationary,
                            static_cast<double>(location.frames_used),
                            static_cast<double>(location.warnings.size()),
                            static_cast<double>(estimate.state),
                            location.ambiguous ? 1.0 : 0.0,
                            location.is_height_estimated ? 1.0 : 0.0,
                            estimate.predicted ? 1.0 : 0.0,
                            estimate.transition ? 1.0 : 0.0});
  }
  return numbers;
}

TEST(CloudTracker, FollowsAWalk) {
  for (const std::size_t access_points : {std::size_t{2}, std::size_t{3}}) {
    DeviceTracker tracker(localizer(access_points), clouds());
    std::vector<DeviceUpdate> updates;
    receive_walk(localizer(access_points)->room(), tracker, 2500, updates);
    EXPECT_EQ(tracker.in_clouds(), 1U);
    std::vector<double> errors;
    int held = 0;
    for (std::size_t i = 10; i < updates.size(); ++i) {
      const LocationEstimate& location = updates[i].estimate.location;
      errors.push_back(error_of(location, walker(50 * static_cast<int>(i))));
      held += errors.back() <= location.accuracy_m ? 1 : 0;
    }
    std::printf("%zu access points: median %.3f m, %d of %zu held\n",
                access_points,
                median(errors),
                held,
                errors.size());
    EXPECT_LT(median(errors), access_points == 2 ? 0.3 : 0.05);
    EXPECT_GE(held, static_cast<int>(errors.size()) * 7 / 10);
  }
}

TEST(CloudTracker, FollowsADeviceAtAnUnknownHeight) {
  const auto unknown = new_localizer(3, 0.3);
  DeviceTracker tracker(unknown, clouds());
  std::vector<DeviceUpdate> updates;
  receive_walk(unknown->room(), tracker, 2000, updates);
  EXPECT_EQ(tracker.in_clouds(), 1U);
  const LocationEstimate& last = updates.back().estimate.location;
  EXPECT_LT(error_of(last, walker(2000)), 0.15);
  EXPECT_TRUE(last.is_height_estimated);
}

// The mean over devices, whose places are drawn differently.
TEST(CloudTracker, StatesTheSpeedOfAWalk) {
  constexpr int kDevices = 6;
  Vec3d mean;
  for (int device = 0; device < kDevices; ++device) {
    const MacAddress address{{2, 0, 0, 0, 0, static_cast<std::uint8_t>(device)}};
    DeviceTracker tracker(localizer(3), clouds());
    std::vector<DeviceUpdate> updates;
    for (int ms = 0; ms <= 2000; ms += 50) {
      tracker.receive(address, frames(localizer(3)->room(), walker(ms), ms, 20.0), updates);
    }
    EXPECT_FALSE(updates.front().estimate.velocity);
    ASSERT_TRUE(updates.back().estimate.velocity);
    std::printf("velocity %.2f, %.2f m/s\n",
                updates.back().estimate.velocity->x,
                updates.back().estimate.velocity->y);
    mean = mean + (1.0 / kDevices) * *updates.back().estimate.velocity;
    EXPECT_LT(updates.back().estimate.stationary, 0.5);
  }
  EXPECT_NEAR(mean.x, 0.5, 0.1);
  EXPECT_NEAR(mean.y, -0.35, 0.1);
}

TEST(CloudTracker, RegionOfAMotionlessDeviceStaysCalibrated) {
  int places = 0;
  int outside = 0;  // of the region of 95 %
  double first_accuracy = 0.0;
  double last_accuracy = 0.0;
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (const double y : {-0.8, 0.0, 0.8}) {
      DeviceTracker tracker(localizer(2), clouds());
      const Vec3d truth{x, y, 1.2};
      std::vector<DeviceUpdate> updates;
      for (int ms = 0; ms <= 1500; ms += 50) {
        tracker.receive(kDevice, frames(localizer(2)->room(), truth, ms, 30.0), updates);
      }
      const FilteredEstimate& last = updates.back().estimate;
      ++places;
      first_accuracy += updates.front().estimate.location.accuracy_m;
      last_accuracy += last.location.accuracy_m;
      outside += error_of(last.location, truth) > last.location.accuracy_m ? 1 : 0;
      EXPECT_GT(last.stationary, 0.8);
    }
  }
  std::printf("of %d places %d outside; accuracy %.2f m, then %.2f m\n",
              places,
              outside,
              first_accuracy / places,
              last_accuracy / places);
  EXPECT_LT(last_accuracy, 1.1 * first_accuracy);
  EXPECT_LE(outside, 2);
}

// A device at rest whose place three access points determine to a centimetre keeps it, also over
// several evaluations of the whole room.
TEST(CloudTracker, ADeviceAtRestKeepsItsPlace) {
  DeviceTracker tracker(localizer(3), clouds());
  const Vec3d truth{-0.9, 0.7, 1.2};
  std::vector<DeviceUpdate> updates;
  for (int ms = 0; ms <= 8000; ms += 100) {
    tracker.receive(kDevice, frames(localizer(3)->room(), truth, ms, 30.0), updates);
    if (ms >= 1000) {
      EXPECT_LT(error_of(updates.back().estimate.location, truth), 0.05) << ms;
      EXPECT_EQ(tracker.in_clouds(), 1U) << ms;
    }
  }
}

TEST(CloudTracker, GoesThroughTheLifeOfATrack) {
  DeviceTracker tracker(localizer(2), clouds());
  std::vector<DeviceUpdate> updates;
  for (int ms = 0; ms <= 1000; ms += 50) {
    tracker.receive(kDevice, frames(localizer(2)->room(), {0.1, 0.2, 1.2}, ms, 30.0), updates);
  }
  tracker.advance(Timestamp(milliseconds(9000)), updates);
  std::vector<TrackState> states;
  std::vector<int> times;
  for (const DeviceUpdate& update : updates) {
    if (const auto& transition = update.estimate.transition) {
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

TEST(CloudTracker, CoastingGrowsTheRegionAndReceptionEndsIt) {
  DeviceTracker tracker(localizer(3), clouds());
  std::vector<DeviceUpdate> updates;
  for (int ms = 0; ms <= 1000; ms += 50) {
    tracker.receive(kDevice, frames(localizer(3)->room(), walker(ms), ms, 30.0), updates);
  }
  EXPECT_EQ(tracker.in_clouds(), 1U);
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
    }
  }
  updates.clear();
  for (int ms = 2700; ms <= 3300; ms += 50) {
    tracker.receive(kDevice, frames(localizer(3)->room(), walker(1500), ms, 30.0), updates);
  }
  ASSERT_FALSE(updates.empty());
  EXPECT_EQ(updates.back().estimate.state, TrackState::kConfirmed);
  EXPECT_LT(error_of(updates.back().estimate.location, walker(1500)), 0.15);
}

// As after a change of the chains' phases: the track continues, and the device may be anywhere.
TEST(CloudTracker, ForgetsPlacesAndFollowsOn) {
  DeviceTracker tracker(localizer(3), clouds());
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
  EXPECT_EQ(tracker.in_clouds(), 1U);
  EXPECT_LT(error_of(updates.back().estimate.location, first), 0.15);
  const FilteredEstimate suspect = receive(first, 1000, {0.4});
  EXPECT_GE(suspect.location.residual_probability, 0.4);
  tracker.forget_places();
  EXPECT_EQ(tracker.in_clouds(), 0U);
  EXPECT_TRUE(tracker.follows(kDevice));
  const FilteredEstimate next = receive(second, 1100);
  EXPECT_EQ(next.state, TrackState::kConfirmed);
  EXPECT_LT(error_of(next.location, second), 0.15);
  EXPECT_EQ(tracker.counters().begun, 1U);
}

// The cloud is at one place, the device suddenly at another one: the odds of the cloud, or an
// evaluation of the whole room, give the device back to the grid.
TEST(CloudTracker, LeavesAWrongPlaceByEvaluatingTheWholeRoom) {
  constexpr int kJump = 1500;   // [ms], when it is followed
  constexpr int kLater = 6500;  // [ms], more than from one evaluation to the next
  DeviceTracker tracker(localizer(3), clouds());
  std::vector<DeviceUpdate> updates;
  const auto place = [](int ms) {  // to and fro, so that the channel changes
    const double swing = 0.15 * std::sin(2e-3 * ms);
    return ms < kJump ? Vec3d{-1.0 + swing, -0.8, 1.2} : Vec3d{1.0 + swing, 0.7, 1.2};
  };
  for (int ms = 0; ms <= kJump + kLater; ms += 100) {
    tracker.receive(kDevice, frames(localizer(3)->room(), place(ms), ms, 20.0), updates);
    if (ms == kJump - 100) {
      EXPECT_EQ(tracker.in_clouds(), 1U);
      EXPECT_LT(error_of(updates.back().estimate.location, place(ms)), 0.1);
    }
  }
  EXPECT_LT(error_of(updates.back().estimate.location, place(kJump + kLater)), 0.3);
}

// A device that one access point leads astray is led back by the first burst of those that join.
TEST(CloudTracker, EvaluatesTheWholeRoomWhenAccessPointsJoin) {
  constexpr int kJoin = 1700;  // [ms]
  for (const Vec3d& middle : {Vec3d{-0.6, -0.3, 1.2}, Vec3d{0.0, 0.9, 1.2}}) {
    DeviceTracker tracker(localizer(3), clouds());
    std::vector<DeviceUpdate> updates;
    for (int ms = 0; ms <= kJoin; ms += 100) {
      const Vec3d place = middle + Vec3d{0.05 * std::sin(2e-3 * ms), 0.0, 0.0};
      auto received = frames(localizer(3)->room(), place, ms, 20.0);
      received.resize(ms < kJoin ? 1 : 3);
      tracker.receive(kDevice, received, updates);
      EXPECT_TRUE(ms != kJoin || error_of(updates.back().estimate.location, place) < 0.2);
    }
    EXPECT_EQ(tracker.in_clouds(), 0U);
  }
}

// Moments of one access point that follow each other soon are answered by the last estimate.
TEST(CloudTracker, MovesTheEstimateBetweenTwoMoments) {
  DeviceTrackerOptions options = clouds();
  options.track.hand_over.max_cells = 0.0;  // also a broad distribution
  options.track.hand_over.return_cells = 0.0;
  DeviceTracker tracker(localizer(1), options);
  std::vector<DeviceUpdate> updates;
  receive_walk(localizer(1)->room(), tracker, 1500, updates);
  EXPECT_EQ(tracker.in_clouds(), 1U);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < updates.size(); ++i) {
    const LocationEstimate& location = updates[i].estimate.location;
    moved += location.frames_used == 0 ? 1 : 0;
    EXPECT_EQ(location.time, Timestamp(milliseconds(50 * static_cast<int>(i))));
    EXPECT_EQ(updates[i].estimate.state == TrackState::kTentative, i < 4);
  }
  EXPECT_GE(moved, 10U);
  EXPECT_LE(moved, 13U);
  EXPECT_EQ(tracker.counters().used, updates.size());
  // Frames of the same time are refused, also after a moved estimate.
  tracker.receive(kDevice, frames(localizer(1)->room(), walker(1500), 1500, 20.0), updates);
  EXPECT_EQ(tracker.counters().out_of_order, 1U);
}

TEST(CloudTracker, TheGridFollowsUnlessACloudIsAskedFor) {
  DeviceTrackerOptions exhaustive = clouds();
  exhaustive.track.is_exhaustive = true;
  for (const DeviceTrackerOptions& options : {DeviceTrackerOptions{}, exhaustive}) {
    DeviceTracker tracker(localizer(3), options);
    std::vector<DeviceUpdate> updates;
    receive_walk(localizer(3)->room(), tracker, 800, updates);
    EXPECT_EQ(tracker.in_clouds(), 0U);
  }
}

struct ByteRun {
  int threads = 1;
  int devices = 1;          // the others are at other places
  bool is_together = true;  // bursts of all devices at once, or one after the other
};
std::vector<double> bytes_of(const std::shared_ptr<const Localizer>& of, const ByteRun& how) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(how.threads));
  DeviceTracker tracker(of, clouds());
  std::vector<DeviceUpdate> updates;
  for (int ms = 0; ms <= 1500; ms += 50) {
    std::vector<std::vector<CsiFrame>> received;
    received.reserve(static_cast<std::size_t>(how.devices));
    for (int device = 0; device < how.devices; ++device) {
      received.push_back(frames(of->room(), walker((400 * device + ms) % 2500), ms, 25.0));
    }
    std::vector<DeviceBurst> bursts;
    bursts.reserve(received.size());
    for (int device = 0; device < how.devices; ++device) {
      bursts.push_back({{{2, 0, 0, 0, 0, static_cast<std::uint8_t>(device)}},
                        received[static_cast<std::size_t>(device)]});
    }
    const std::size_t at_once = how.is_together ? bursts.size() : 1;
    for (std::size_t i = 0; i < bursts.size(); i += at_once) {
      for (const auto& of_device : tracker.receive(std::span(bursts).subspan(i, at_once))) {
        for (const DeviceUpdate& update : of_device) {
          if (update.device == bursts.front().device) {
            updates.push_back(update);
          }
        }
      }
    }
  }
  EXPECT_GE(tracker.in_clouds(), 1U);
  return numbers_of(updates);
}

TEST(CloudTracker, GivesTheSameBytes) {
  for (const std::size_t access_points : {std::size_t{1}, std::size_t{3}}) {
    const auto expected = bytes_of(localizer(access_points), {});
    EXPECT_EQ(bytes_of(localizer(access_points), {2, 1, true}), expected);
    EXPECT_EQ(bytes_of(localizer(access_points), {8, 1, true}), expected);
    EXPECT_EQ(bytes_of(localizer(access_points), {1, 4, true}), expected);
    EXPECT_EQ(bytes_of(localizer(access_points), {8, 4, true}), expected);
    EXPECT_EQ(bytes_of(localizer(access_points), {2, 4, false}), expected);
    // Boxes made anew, and those of another walk kept.
    const auto other = new_localizer(access_points);
    EXPECT_EQ(bytes_of(other, {}), expected);
    DeviceTracker warming(other, clouds());
    std::vector<DeviceUpdate> unused;
    for (int ms = 0; ms <= 1000; ms += 50) {
      warming.receive(kDevice, frames(other->room(), walker(2500 - ms), ms, 25.0), unused);
    }
    EXPECT_EQ(bytes_of(other, {}), expected);
  }
}

// Beside the parts that all tracks of a room share.
TEST(CloudTracker, ATrackTakesLittleMemory) {
  if (mallinfo2().uordblks == 0) {
    GTEST_SKIP() << "a sanitizer's allocator does not count";
  }
  constexpr int kDevices = 20;
  for (const std::size_t access_points : {std::size_t{1}, std::size_t{3}}) {
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    DeviceTrackerOptions options = clouds();
    options.track.hand_over.max_cells = 0.0;
    options.track.hand_over.return_cells = 0.0;
    const auto run = [&] {
      auto tracker = std::make_unique<DeviceTracker>(localizer(access_points), options);
      for (int device = 0; device < kDevices; ++device) {
        std::vector<DeviceUpdate> updates;
        const MacAddress address{{2, 0, 0, 0, 1, static_cast<std::uint8_t>(device)}};
        for (int ms = 0; ms <= 1400; ms += 100) {
          const RoomModel& room = localizer(access_points)->room();
          tracker->receive(address, frames(room, walker(50 * device + ms), ms, 20.0), updates);
        }
      }
      return tracker;
    };
    auto tracker = run();
    EXPECT_GE(tracker->in_clouds(), static_cast<std::size_t>(kDevices) * 9 / 10);
    const std::size_t with_tracks = mallinfo2().uordblks;
    tracker.reset();
    const std::size_t of_tracks = with_tracks - mallinfo2().uordblks;
    std::printf("%zu access points: %zu KiB a track\n", access_points, of_tracks / kDevices / 1024);
    EXPECT_LE(of_tracks / kDevices, 64U * 1024U) << access_points;
    EXPECT_GT(of_tracks / kDevices, 1024U) << "or it was not measured";
  }
}

}  // namespace
}  // namespace rayloc::cloud_tracker_test
