// A place from a likelihood over the plan of a room: the same for every method that has one.
#pragma once

#include <functional>

#include "engine/base/vec3.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct PlanMapOptions {
  double step = 0.05;                 // [m], of the cells; more where the room is large
  double accuracy_confidence = 0.95;  // of what is stated as accuracy
  // Probability that the map says nothing of the place, as RayLoc has it with one access point:
  // what a wrong path leaves is in the map itself.
  double elsewhere = 0.03;
};

// Fills what summarise_posterior() does, and the loss. log_likelihood: of a device at a place, from
// many threads.
void summarise_plan(const RoomModel& room,
                    const PlanMapOptions& options,
                    const std::function<double(const Vec3d& place)>& log_likelihood,
                    LocationEstimate& estimate);

}  // namespace rayloc
