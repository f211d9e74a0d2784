// A track that looks where the device may be, beside one that compares every moment with the whole
// room: how often the first loses what the second ranks first.
//
// The short form has 40 moments of each case. RAYLOC_PRUNED_MOMENTS asks for more, of walks that
// begin anew every hundred: then one of a thousand may be lost (tests/soak/run pruned).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "engine/track/device_tracker.h"
#include "tests/support/scenes.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::pruned_answer_test {
namespace {

constexpr int kShort = 40;           // moments of a case
constexpr int kOfOneWalk = 100;      // moments
constexpr double kSpeed = 0.8;       // [m/s]
constexpr double kFromWalls = 0.3;   // [m]
constexpr double kSamePlace = 0.15;  // [m]
constexpr double kDeviations = 2.0;  // of a hypothesis, within which a place is named by it
const MacAddress kWalker{{2, 0, 0, 0, 0, 1}};

struct Case {
  double size = 0.0;  // of the room in x, a share of the small one's
  std::size_t access_points = 0;
  double height_sigma = 0.0;  // [m]
};

// The small room, or one as much larger.
RoomModel room_of(const Case& of) {
  RoomModel room = test::make_room();
  const double x = room.bounds_max.x * of.size;
  const double y = room.bounds_max.y * of.size;
  const double z = room.bounds_max.z;
  using test::box_mesh;
  room.scene = test::make_scene({{"west", box_mesh({-x - 0.1, -y, 0}, {-x, y, z})},
                                 {"east", box_mesh({x, -y, 0}, {x + 0.1, y, z})},
                                 {"south", box_mesh({-x, -y - 0.1, 0}, {x, -y, z})},
                                 {"north", box_mesh({-x, y, 0}, {x, y + 0.1, z})},
                                 {"floor", box_mesh({-x, -y, -0.1}, {x, y, 0})}},
                                test::kConcrete);
  room.bounds_min = {-x, -y, 0.0};
  room.bounds_max = {x, y, z};
  room.access_points.resize(of.access_points);
  for (RoomAccessPoint& ap : room.access_points) {
    ap.array.pose.position.x *= of.size;
    ap.array.pose.position.y *= of.size;
  }
  room.device.height_sigma = of.height_sigma;
  return room;
}

// From one place of the room to the next; its numbers are the same on every machine.
class Walker {
 public:
  Walker(const RoomModel& room, unsigned seed) : room_(room), draw_(seed) {
    aim(at_);
    aim(to_);
  }

  Vec3d step(double seconds) {
    const double far = std::hypot(to_.x - at_.x, to_.y - at_.y);
    const double distance = kSpeed * seconds;
    if (far <= distance) {
      at_ = to_;
      aim(to_);
    } else {
      at_ = at_ + (distance / far) * (to_ - at_);
    }
    return at_;
  }

 private:
  double between(double low, double high) {
    return low +
           (high - low) * static_cast<double>(draw_()) / static_cast<double>(std::mt19937::max());
  }
  void aim(Vec3d& place) {
    const Vec3d& low = room_.bounds_min;
    const Vec3d& high = room_.bounds_max;
    place = {between(low.x + kFromWalls, high.x - kFromWalls),
             between(low.y + kFromWalls, high.y - kFromWalls),
             room_.device.height + room_.device.height_sigma * between(-1.0, 1.0)};
  }

  const RoomModel& room_;
  std::mt19937 draw_;
  Vec3d at_, to_;
};

// True if the place is near one of the hypotheses, or within its spread.
bool names(const LocationEstimate& estimate, const Vec3d& place) {
  return std::any_of(
      estimate.hypotheses.begin(), estimate.hypotheses.end(), [&](const Hypothesis& one) {
        const double x = place.x - one.position.x;
        const double y = place.y - one.position.y;
        const auto& c = one.covariance;
        const double determinant = c[0] * c[4] - c[1] * c[3];
        const double square = (c[4] * x * x - 2.0 * c[1] * x * y + c[0] * y * y) / determinant;
        return std::hypot(x, y) < kSamePlace || square < kDeviations * kDeviations;
      });
}

struct Count {
  int compared = 0;
  int lost = 0;
};

Count count_lost(const Case& of, int moments) {
  const auto room = std::make_shared<const RoomModel>(room_of(of));
  const auto localizer = std::make_shared<const Localizer>(*Localizer::create(room, {}));
  DeviceTrackerOptions whole;
  whole.track.is_exhaustive = true;
  Count count;
  for (int first = 0; first < moments; first += kOfOneWalk) {
    DeviceTracker exhaustive(localizer, whole);
    DeviceTracker tracker(localizer, {});
    const auto walk = static_cast<unsigned>(first / kOfOneWalk);
    Walker walker(*room, walk + 1);
    for (int i = 0; i < std::min(kOfOneWalk, moments - first); ++i) {
      auto frames = test::frames_at(
          *room, walker.step(0.05), {1, 20.0, static_cast<unsigned>(first + i + 1)});
      for (CsiFrame& frame : frames) {
        frame.time = Timestamp(std::chrono::milliseconds(50 * i));
      }
      std::vector<DeviceUpdate> expected;
      std::vector<DeviceUpdate> found;
      exhaustive.receive(kWalker, frames, expected);
      tracker.receive(kWalker, frames, found);
      EXPECT_EQ(expected.size(), found.size()) << first << ' ' << i;
      if (expected.empty() || expected.front().estimate.location.hypotheses.empty()) {
        continue;
      }
      ++count.compared;
      const Vec3d& first_place = expected.front().estimate.location.hypotheses.front().position;
      count.lost += found.empty() || !names(found.front().estimate.location, first_place) ? 1 : 0;
    }
  }
  return count;
}

TEST(PrunedAnswer, NamesThePlaceThatTheWholeRoomRanksFirst) {
  const char* const asked = std::getenv("RAYLOC_PRUNED_MOMENTS");
  const bool is_long = asked != nullptr;
  const int moments = is_long ? std::atoi(asked) : kShort;
  ASSERT_GT(moments, 0);
  std::vector<Case> cases = {{1.0, 1, 0.0}, {1.0, 2, 0.0}};
  if (is_long) {
    cases = {{1.0, 1, 0.0},
             {1.0, 3, 0.0},
             {1.0, 1, 0.3},
             {1.0, 3, 0.3},
             {2.0, 1, 0.0},
             {2.0, 3, 0.0},
             {2.0, 1, 0.3},
             {2.0, 3, 0.3}};
  }
  Count all;
  for (const Case& one : cases) {
    const Count count = count_lost(one, moments);
    std::printf("%.1f m long, %zu access points, height +-%.1f m: %d moments, %d lost\n",
                3.0 * one.size,
                one.access_points,
                one.height_sigma,
                count.compared,
                count.lost);
    std::fflush(stdout);
    all.compared += count.compared;
    all.lost += count.lost;
  }
  EXPECT_GT(all.compared, static_cast<int>(cases.size()) * moments * 9 / 10);
  EXPECT_LE(all.lost, all.compared / 1000);
}

}  // namespace
}  // namespace rayloc::pruned_answer_test
