// The mirrors of M3: large planes of the scene that bound the room.
#pragma once

#include <vector>

#include "engine/base/vec3.h"
#include "engine/room/room_model.h"
#include "engine/scene/surface.h"

namespace rayloc {

// Vertical planes of 1 m^2 and more, floor and ceiling; of closely spaced parallel planes only the
// one nearest to `from`. `from`: the access point.
std::vector<Plane<double>> reflectors_of(const RoomModel& room, const Vec3d& from);
bool is_vertical(const Plane<double>& plane);

// The mirror image of the place.
Vec3d mirrored(const Plane<double>& plane, const Vec3d& place);

}  // namespace rayloc
