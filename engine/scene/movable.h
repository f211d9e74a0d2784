// What people move without asking: chairs, small boxes, whatever else is small and low. A person
// may stand where it stood, and tomorrow it stands elsewhere.
#pragma once

#include <algorithm>

#include "engine/scene/bounds.h"

namespace rayloc {

inline constexpr double kMovableHeight = 1.2;  // [m], of the top above the floor
inline constexpr double kMovableWidth = 0.7;   // [m], the longer side

// Whether an object of these bounds is, in a room with this floor [m].
inline bool is_movable(const Bounds& object, double floor) {
  const Vec3d size = object.size();
  return object.upper.z - floor < kMovableHeight && std::max(size.x, size.y) < kMovableWidth;
}

}  // namespace rayloc
