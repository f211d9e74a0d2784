// Objects that people move without notice: chairs, small boxes and other small, low objects. The
// modelled position of such an object may be free, and its actual position different.
#pragma once

#include <algorithm>

#include "engine/scene/bounds.h"

namespace rayloc {

inline constexpr double kMovableHeight = 1.2;  // [m], of the top above the floor
inline constexpr double kMovableWidth = 0.7;   // [m], the longer side

// True if an object of these bounds is movable, in a room with this floor [m].
inline bool is_movable(const Bounds& object, double floor) {
  const Vec3d size = object.size();
  return object.upper.z - floor < kMovableHeight && std::max(size.x, size.y) < kMovableWidth;
}

}  // namespace rayloc
