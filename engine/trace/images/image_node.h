// ImageNode: one sequence of mirrors of a tree of images (image_tree.h).
#pragma once

#include <cstdint>

#include "engine/base/vec3.h"

namespace rayloc {

// No index of a node: the parent of a first mirror is a root.
inline constexpr std::uint32_t kRootNode = 0xffffffff;
// Roots that may share a tree: so many bits has RootSet.
inline constexpr std::size_t kMaxRoots = 32;
using RootSet = std::uint32_t;  // bit i: root i

struct ImageNode {
  std::uint32_t surface;  // the last mirror
  std::uint32_t parent;   // index of a node, or kRootNode
  RootSet roots;          // whose waves come to the mirror from the same side
};

// Of a root, through all mirrors of a node.
struct Image {
  Vec3d point;            // [m]
  double distance = 0.0;  // of `point` from the last mirror's plane; never 0 where it counts
};

}  // namespace rayloc
