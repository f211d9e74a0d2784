#include "engine/trace/image_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/trace/blocked_chains.h"
#include "engine/trace/image_tree_builder.h"

namespace rayloc {
namespace {

// Closer to a mirror's plane than this, a point is on it and has no reflection there [m].
constexpr double kOnPlane = 1e-9;

}  // namespace

ImageTree::ImageTree(const Scene& scene, const Vec3d& root, const TraceOptions& options)
    : scene_(&scene),
      root_(root),
      margin_(options.softness),
      clear_only_(!options.transmission && options.softness == 0.0) {
  GrownTree grown = grow_image_tree(scene, root, options);
  generator_ = grown.generator;
  nodes_ = std::move(grown.nodes);
  index_ = std::make_shared<const BeamIndex>(
      std::move(grown.beams), root, scene.bounds_min(), scene.bounds_max());
}

std::size_t ImageTree::bytes() const {
  return nodes_.capacity() * sizeof(ImageNode) + index_->bytes();
}

bool ImageTree::back_trace(std::uint32_t leaf, const Vec3d& target, SpecularChain& chain) const {
  chain.surfaces.clear();
  chain.points.clear();
  Vec3d point = target;
  for (std::uint32_t i = leaf; i != kRootNode; i = nodes_[i].parent) {
    const ImageNode& node = nodes_[i];
    const Surface& surface = scene_->surfaces()[node.surface];
    const double here = distance(surface.plane(), point);
    // The point must be in front of the mirror: on the other side than the image.
    if (node.image_distance < 0.0 ? here < kOnPlane : here > -kOnPlane) {
      return false;
    }
    point = point + (here / (here - node.image_distance)) * (node.image - point);
    if (!surface.contains(point, margin_)) {
      return false;
    }
    chain.surfaces.push_back(node.surface);
    chain.points.push_back(point);
  }
  std::reverse(chain.surfaces.begin(), chain.surfaces.end());
  std::reverse(chain.points.begin(), chain.points.end());
  return true;
}

bool ImageTree::is_clear(const SpecularChain& chain, const Vec3d& target) const {
  Segment segment{root_, root_, kNoSurface, kNoSurface};
  for (std::size_t i = 0; i <= chain.points.size(); ++i) {
    const bool last = i == chain.points.size();
    segment.to = last ? target : chain.points[i];
    segment.to_surface = last ? kNoSurface : chain.surfaces[i];
    if (scene_->is_blocked(segment)) {
      return false;
    }
    segment.from = segment.to;
    segment.from_surface = segment.to_surface;
  }
  return true;
}

bool ImageTree::is_direct(const Vec3d& target) const {
  return norm(target - root_) > kOnPlane && (!clear_only_ || is_clear({}, target));
}

std::vector<std::uint32_t> ImageTree::candidates(const Vec3d& target) const {
  std::vector<std::uint32_t> nodes;
  const BlockedChains blocked(*scene_, nodes_, root_);
  index_->find(target, nodes, [&](std::uint32_t node, const CubeRegion& region) {
    return clear_only_ && blocked.holds(node, region);
  });
  return nodes;
}

std::size_t ImageTree::chains_to(const Vec3d& target, std::vector<SpecularChain>& chains) const {
  std::size_t count = 0;
  visit_chains(target, [&](const SpecularChain& chain) {
    if (count == chains.size()) {
      chains.emplace_back();
    }
    chains[count++] = chain;
  });
  return count;
}

}  // namespace rayloc
