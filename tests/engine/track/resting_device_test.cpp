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

// Each frame differs from the one before by its noise, also where it is not small.
TEST(RestingDevice, NoiseIsNotNew) {
  double first_accuracy = 0.0;
  double last_accuracy = 0.0;
  for (const Vec3d& truth : {Vec3d{-0.4, -0.5, 1.2}, Vec3d{1.2, 0.5, 1.2}, Vec3d{0.4, 1.0, 1.2}}) {
    DeviceTracker tracker(localizer(), {});
    std::vector<DeviceUpdate> updates;
    for (int ms = 0; ms <= 20000; ms += 100) {
      tracker.receive(kDevice, frames(localizer()->room(), truth, ms, 22.0), updates);
    }
    first_accuracy += updates.front().estimate.location.accuracy_m;
    last_accuracy += updates.back().estimate.location.accuracy_m;
  }
  std::printf("accuracy %.2f m, after 20 s %.2f m\n", first_accuracy / 3.0, last_accuracy / 3.0);
  EXPECT_GT(last_accuracy, 0.7 * first_accuracy);
}

}  // namespace
}  // namespace rayloc::resting_device_test
