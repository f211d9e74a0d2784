// Is a point in the middle of a wall? A device or an access point there hears nothing.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/base/vec3.h"
#include "engine/scene/scene.h"

namespace rayloc {

// Bounds that differ less are the same.
inline constexpr double kSameBounds = 1e-6;  // [m]

// The closed object that the point is inside of; nothing when there is none. An object as large as
// the whole scene is no wall but the shell of the room, which everything is inside of.
std::optional<std::uint32_t> solid_around(const Scene& scene, const Vec3d& point);

}  // namespace rayloc
