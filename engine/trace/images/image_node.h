// ImageNode: one sequence of mirrors of a tree of images (image_tree.h).
#pragma once

#include <cstdint>

#include "engine/base/vec3.h"

namespace rayloc {

// No index of a node: the parent of a first mirror is a root.
inline constexpr std::uint32_t kRootNode = 0xffffffff;
// Maximum number of roots of a tree: the bits of RootSet.
inline constexpr std::size_t kMaxRoots = 32;
using RootSet = std::uint32_t;  // bit i: root i

struct ImageNode {
  std::uint32_t surface;  // the last mirror
  std::uint32_t parent;   // index of a node, or kRootNode
  RootSet roots;          // roots whose waves reach the mirror from the same side
};

// Image of a root through all mirrors of a node.
struct Image {
  Vec3d point;            // [m]
  double distance = 0.0;  // of `point` from the last mirror's plane; never 0 where it is used
};

}  // namespace rayloc
