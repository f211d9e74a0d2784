// mistakes_of_places: where the points of a survey really were, if it made one of the mistakes that
// surveys are known for.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/calibrate/room_calibration.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct PlaceMistake {
  std::string meaning;                      // "with x and y exchanged"
  std::function<Vec3d(std::size_t)> place;  // of a point
};

// Only those that put every point inside of the room. Columns exchanged, axes that run the other
// way (from the same origin, or from the other end of the room), rows one off or in reverse order.
// REQUIRES: `points` outlive the result.
std::vector<PlaceMistake> mistakes_of_places(const RoomModel& room,
                                             std::span<const CalibrationPoint> points);

}  // namespace rayloc
