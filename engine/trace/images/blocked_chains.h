// BlockedChains: chains of mirrors without a path to a region, because the same surface blocks all
// their paths to it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/trace/images/beam_index.h"
#include "engine/trace/images/image_node.h"

namespace rayloc {

class BlockedChains {
 public:
  // REQUIRES: a tree of images (image_tree.h) of opaque surfaces with hard edges.
  BlockedChains(const Scene& scene,
                std::span<const ImageNode> nodes,
                std::span<const Image> images,
                std::span<const Vec3d> roots)
      : scene_(scene), nodes_(nodes), images_(images), roots_(roots) {}

  // True if every path from any root over the chain of node `leaf` to a point of the region is
  // certainly blocked; false means undecided.
  bool holds(std::uint32_t leaf, const CubeRegion& region) const;

 private:
  // The middle of the region and its corners, or the points where paths to them meet a mirror.
  static constexpr std::size_t kCorners = 8;
  struct Bundle {
    Vec3d middle;
    std::array<Vec3d, kCorners> corners;
    std::uint32_t surface = kNoSurface;  // the surface of the points
  };

  bool holds(std::size_t root, std::uint32_t leaf, const CubeRegion& region) const;
  // Tests the part from the mirror `node` (kRootNode: the root) to `to`, seen from `apex`, the
  // image that lights it, starting at `from`.
  bool is_blocked(std::uint32_t node, const Vec3d& from, const Vec3d& apex, const Bundle& to) const;

  const Scene& scene_;
  std::span<const ImageNode> nodes_;
  std::span<const Image> images_;
  std::span<const Vec3d> roots_;
};

}  // namespace rayloc
