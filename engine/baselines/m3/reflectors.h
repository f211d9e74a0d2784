// The mirrors that M3 knows of: large planes of the scene that bound the room.
#pragma once

#include <vector>

#include "engine/base/vec3.h"
#include "engine/room/room_model.h"
#include "engine/scene/surface.h"

namespace rayloc {

// Vertical planes of 1 m^2 and more, floor and ceiling; of parallel ones close behind each other
// that which `from` sees first. `from`: the access point.
std::vector<Plane<double>> reflectors_of(const RoomModel& room, const Vec3d& from);
bool is_vertical(const Plane<double>& plane);

// The place behind the mirror.
Vec3d mirrored(const Plane<double>& plane, const Vec3d& place);

}  // namespace rayloc
