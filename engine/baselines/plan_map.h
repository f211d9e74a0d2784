// Converts a likelihood over the plan of a room to an estimate; shared by the methods.
#pragma once

#include <functional>

#include "engine/base/vec3.h"
#include "engine/room/location_estimate.h"
#include "engine/room/room_model.h"

namespace rayloc {

struct PlanMapOptions {
  double step = 0.05;                 // [m], of the cells; larger in a large room
  double accuracy_confidence = 0.95;  // probability within the reported accuracy
  // Outlier probability of the map, as in RayLoc with one access point: the effect of a wrong path
  // is already in the map.
  double outlier = 0.03;
};

// Sets the fields of summarise_posterior(), and the loss. log_likelihood: for a device at a place,
// called from many threads.
void summarise_plan(const RoomModel& room,
                    const PlanMapOptions& options,
                    const std::function<double(const Vec3d& place)>& log_likelihood,
                    LocationEstimate& estimate);

}  // namespace rayloc
