// Checks if a point is inside a wall: a device or an access point there has no signal.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/base/vec3.h"
#include "engine/scene/scene.h"

namespace rayloc {

// Bounds that differ by less are equal.
inline constexpr double kSameBounds = 1e-6;  // [m]

// The closed object that contains the point; empty if there is none. An object as large as the
// whole scene is no wall but the shell of the room, which contains everything.
std::optional<std::uint32_t> solid_around(const Scene& scene, const Vec3d& point);

}  // namespace rayloc
