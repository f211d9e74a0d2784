#include "tests/bench/laboratory_room.h"

#include <utility>

#include "tests/support/laboratory.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::bench {

RoomModel laboratory_room(const LaboratorySize& size) {
  RoomModel room = test::make_room();
  const std::vector<RoomAccessPoint> radios = room.access_points;
  room.name = "laboratory";
  room.scene = test::laboratory();
  room.bounds_min = {0.0, 0.0, 0.0};
  room.bounds_max = {size.length, 5.6, 3.0};
  room.trace.max_depth = size.depth;
  room.access_points.clear();
  const std::vector<Vec3d> places = {{1.2, 4.7, 1.9}, {9.0, 0.9, 1.9}, {5.2, 5.2, 1.9}};
  for (std::size_t i = 0; i < static_cast<std::size_t>(size.access_points); ++i) {
    RoomAccessPoint ap = radios[i];
    ap.array = test::laboratory_access_point();
    ap.array.pose.position = places[i];
    room.access_points.push_back(std::move(ap));
  }
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    room.access_points[i].gains = test::make_gains(room, i);
  }
  return room;
}

}  // namespace rayloc::bench
