// Determines the up axis of a scene from its floor and its ceiling; the file does not state it.
#pragma once

#include <cstddef>
#include <optional>

#include "engine/scene/scene.h"

namespace rayloc {

// The axis by names: objects and materials named floor, ground, ceiling or roof are perpendicular
// to this axis (0 x, 1 y, 2 z). Empty if no object has such a name, or all are correct.
struct NamedUp {
  std::size_t axis = 2;
  bool certain = false;  // a floor and a ceiling face each other along it
};
std::optional<NamedUp> wrong_up_by_name(const Scene& scene);

// Number (0 to 2) of floor and ceiling across this axis: faces that cover a large part of the view
// along it, in the lowest third of the scene, and above that.
int large_faces(const Scene& scene, std::size_t axis);

}  // namespace rayloc
