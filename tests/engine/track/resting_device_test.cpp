// Devices at rest: later bursts through the same channel carry no new information.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>
#include <vector>

#include "engine/track/device_tracker.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::resting_device_test {
namespace {

using std::chrono::milliseconds;

const MacAddress kDevice{{2, 0, 0, 0, 0, 1}};

// Two access points: a snapshot is often ambiguous.
std::shared_ptr<const Localizer> localizer() {
  static const auto kMade = [] {
    RoomModel room = test::make_room();
    room.access_points.resize(2);
    return std::make_shared<const Localizer>(
        *Localizer::create(std::make_shared<const RoomModel>(std::move(room)), {}));
  }();
  return kMade;
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

TEST(RestingDevice, RegionStaysCalibrated) {
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
        tracker.receive(kDevice, frames(localizer()->room(), truth, ms, 30.0), updates);
      }
      const FilteredEstimate& first = updates.front().estimate;
      const FilteredEstimate& last = updates.back().estimate;
      ++places;
      first_accuracy += first.location.accuracy_m;
      last_accuracy += last.location.accuracy_m;
      outside += error_of(last.location, truth) > last.location.accuracy_m ? 1 : 0;
      EXPECT_GT(last.stationary, 0.9);
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

TEST(RestingDevice, RepeatedChannelAddsNoMoreThanASnapshot) {
  DeviceTracker tracker(localizer(), {});
  std::vector<DeviceUpdate> updates;
  const Vec3d truth{-0.4, -0.5, 1.2};
  for (int ms = 0; ms <= 3000; ms += 50) {
    tracker.receive(kDevice, frames(localizer()->room(), truth, ms, 60.0), updates);
  }
  const LocationEstimate snapshot =
      localizer()->locate(frames(localizer()->room(), truth, 0, 60.0));
  EXPECT_GT(updates.back().estimate.location.accuracy_m, 0.5 * snapshot.accuracy_m);
}

const std::vector<Vec3d> kPlaces = {{-0.4, -0.5, 1.2}, {1.2, 0.5, 1.2}, {0.4, 1.0, 1.2}};

struct Accuracy {
  double first = 0.0;
  double last = 0.0;
};

// Mean accuracy [m] over places, of the first and the last estimate. times: of frames [ms].
// receives: true if an access point receives frame n.
template <typename Receives>
Accuracy accuracy(const std::vector<int>& times, const Receives& receives) {
  Accuracy mean;
  for (const Vec3d& truth : kPlaces) {
    DeviceTracker tracker(localizer(), {});
    std::vector<DeviceUpdate> updates;
    for (std::size_t n = 0; n < times.size(); ++n) {
      auto received = frames(localizer()->room(), truth, times[n], 22.0);
      std::erase_if(received, [&](const CsiFrame& one) { return !receives(n, one.access_point); });
      tracker.advance(Timestamp(milliseconds(times[n])), updates);
      tracker.receive(kDevice, received, updates);
    }
    const auto places = static_cast<double>(kPlaces.size());
    mean.first += updates.front().estimate.location.accuracy_m / places;
    mean.last += updates.back().estimate.location.accuracy_m / places;
  }
  std::printf("accuracy %.2f m, at the end %.2f m\n", mean.first, mean.last);
  return mean;
}

std::vector<int> every(int step, int end) {
  std::vector<int> times;
  for (int ms = 0; ms <= end; ms += step) {
    times.push_back(ms);
  }
  return times;
}
bool by_all(std::size_t /*n*/, std::size_t /*access_point*/) { return true; }

// Each frame differs from the one before by its noise, also where it is not small.
TEST(RestingDevice, NoiseIsNotNew) {
  const Accuracy of = accuracy(every(100, 20000), by_all);
  EXPECT_GT(of.last, 0.7 * of.first);
  EXPECT_LT(of.last, 1.3 * of.first);
}

// Between two frames the filter moves mass, which only evidence brings back.
TEST(RestingDevice, RegionStaysAtOneFrameASecond) {
  const Accuracy of = accuracy(every(900, 54000), by_all);
  EXPECT_GT(of.last, 0.5 * of.first);
  EXPECT_LT(of.last, 1.3 * of.first);
}

TEST(RestingDevice, RegionReturnsAfterASilence) {
  std::vector<int> times = every(100, 2000);
  for (int ms = 5000; ms <= 7000; ms += 100) {
    times.push_back(ms);
  }
  const Accuracy of = accuracy(times, by_all);
  EXPECT_GT(of.last, 0.5 * of.first);
  EXPECT_LT(of.last, 1.3 * of.first);
}

// Access points that receive in turn have one credit; each channel is compared with its own.
TEST(RestingDevice, AccessPointsInTurnAddNoMoreThanASnapshotEach) {
  const auto in_turn = [](std::size_t n, std::size_t access_point) {
    return access_point == n % 2;
  };
  const Accuracy alone = accuracy(every(100, 1000), in_turn);
  const Accuracy longer = accuracy(every(100, 10000), in_turn);
  EXPECT_GT(longer.last, 0.7 * alone.last);
}

// The second access point is absent for more than five seconds again and again.
TEST(RestingDevice, AnAccessPointThatReturnsAddsNothingThroughTheSameChannel) {
  const auto one_returns = [](std::size_t n, std::size_t access_point) {
    return access_point == 0 || n % 20 == 0;
  };
  const Accuracy of = accuracy(every(300, 36000), one_returns);
  EXPECT_GT(of.last, 0.7 * of.first);
}

// Noise may hide a movement: then an equal channel neither holds the device in its place nor makes
// it one at rest.
TEST(RestingDevice, AWalkAtALowSnrIsNoRest) {
  DeviceTracker tracker(localizer(), {});
  std::vector<DeviceUpdate> updates;
  double stationary = 0.0;
  for (int ms = 0; ms <= 3000; ms += 100) {
    const Vec3d at{-1.2 + 0.8e-3 * ms, -0.5, 1.2};
    tracker.receive(kDevice, frames(localizer()->room(), at, ms, 3.0), updates);
    stationary += updates.back().estimate.stationary;
  }
  EXPECT_LT(stationary, 0.4 * static_cast<double>(updates.size()));
  EXPECT_GT(error_of(updates.back().estimate.location, {-1.2, -0.5, 1.2}), 1.0);
}

}  // namespace
}  // namespace rayloc::resting_device_test
