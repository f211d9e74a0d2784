// ImageNode: one image of a tree (image_tree.h).
#pragma once

#include <cstdint>

#include "engine/base/vec3.h"

namespace rayloc {

inline constexpr std::uint32_t kRootNode = 0xffffffff;

struct ImageNode {
  Vec3d image;            // of the root, through the whole chain [m]
  double image_distance;  // of `image` from the surface's plane; never 0
  std::uint32_t surface;
  std::uint32_t parent;  // index of a node, or kRootNode
};

}  // namespace rayloc
