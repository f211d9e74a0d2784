#include "tests/bench/hall_room.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "tests/support/box_scene.h"
#include "tests/support/laboratory.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::bench {
namespace {

constexpr double kTop = 3.0;         // [m]
constexpr double kWall = 0.2;        // [m]
constexpr double kFromWall = 0.3;    // [m], of an access point
constexpr double kSpacing = 0.3125;  // [MHz], of two tones

OfdmGrid grid_of(int bandwidth_mhz, double centre_hz) {
  // 802.11 leaves a tenth of the tones to the guard at either end.
  const int last = 2 * static_cast<int>(0.46 * bandwidth_mhz / kSpacing / 2.0);
  OfdmGrid grid{centre_hz, 1e6 * kSpacing, {}};
  for (int k = -last; k <= last; k += 2) {
    if (k != 0) {
      grid.tone_index.push_back(static_cast<std::int16_t>(k));
    }
  }
  return grid;
}

// Around the walls, from the middle of the western one on.
Pose place_along_walls(double share, double length) {
  const double distance = 4.0 * share + 0.5;
  const double along = distance - std::floor(distance);
  const double from = kFromWall;
  const double to = length - kFromWall;
  const double at = from + along * (to - from);
  Pose pose;
  switch (static_cast<int>(distance) % 4) {
    case 0:
      pose.position = {from, at, 1.9};
      break;
    case 1:
      pose.position = {at, to, 1.9};
      break;
    case 2:
      pose.position = {to, length - at, 1.9};
      break;
    default:
      pose.position = {length - at, from, 1.9};
      break;
  }
  pose.orientation.yaw = std::atan2(0.5 * length - pose.position.y, 0.5 * length - pose.position.x);
  return pose;
}

}  // namespace

double hall_length(const HallSize& size) { return std::sqrt(size.area); }

RoomModel hall_room(const HallSize& size) {
  const double l = hall_length(size);
  RoomModel room = test::make_room();
  const RoomAccessPoint radio = room.access_points.front();
  room.name = "hall";
  room.scene = test::scene_of_boxes({{"floor", "concrete", {0, 0, -kWall}, {l, l, 0}},
                                     {"west", "concrete", {-kWall, 0, 0}, {0, l, kTop}},
                                     {"east", "concrete", {l, 0, 0}, {l + kWall, l, kTop}},
                                     {"south", "concrete", {0, -kWall, 0}, {l, 0, kTop}},
                                     {"north", "concrete", {0, l, 0}, {l, l + kWall, kTop}}});
  room.bounds_min = {0.0, 0.0, 0.0};
  room.bounds_max = {l, l, kTop};
  room.trace.max_depth = 2;
  room.grid = grid_of(size.bandwidth_mhz, room.grid.centre_hz);
  room.access_points.clear();
  for (std::size_t i = 0; i < size.access_points; ++i) {
    RoomAccessPoint ap = radio;
    ap.id = "ap" + std::to_string(i + 1);
    ap.array = test::laboratory_access_point();
    ap.array.pose =
        place_along_walls(static_cast<double>(i) / static_cast<double>(size.access_points), l);
    room.access_points.push_back(std::move(ap));
  }
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    room.access_points[i].gains = test::make_gains(room, i);
  }
  return room;
}

}  // namespace rayloc::bench
