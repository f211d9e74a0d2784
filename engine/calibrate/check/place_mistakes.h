// mistakes_of_places: actual places of a survey's points under each of the usual mistakes of
// surveys.
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
  std::function<Vec3d(std::size_t)> place;  // place of a point
};

// Returns only those that place every point inside the room: columns exchanged, axes reversed (from
// the same origin, or from the other end of the room), rows one off or in reverse order. REQUIRES:
// `points` outlive the result.
std::vector<PlaceMistake> mistakes_of_places(const RoomModel& room,
                                             std::span<const CalibrationPoint> points);

}  // namespace rayloc
