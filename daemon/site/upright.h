// Which way is up in a scene? A file does not say; its floor and its ceiling do.
#pragma once

#include <cstddef>
#include <optional>

#include "engine/scene/scene.h"

namespace rayloc {

// What the names tell: objects and materials that are called floor, ground, ceiling or roof lie
// across this axis (0 x, 1 y, 2 z). Nothing where nothing is called so, or all is as it should be.
struct NamedUp {
  std::size_t axis = 2;
  bool certain = false;  // a floor and a ceiling face each other along it
};
std::optional<NamedUp> wrong_up_by_name(const Scene& scene);

// How many there are, of a floor and a ceiling across this axis: faces that cover a good part of
// what is seen along it, in the lowest third of the scene, and above that.
int large_faces(const Scene& scene, std::size_t axis);

}  // namespace rayloc
