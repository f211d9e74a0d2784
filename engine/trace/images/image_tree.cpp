#include "engine/trace/images/image_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/trace/images/blocked_chains.h"
#include "engine/trace/images/image_tree_builder.h"
#include "engine/trace/images/tolerances.h"

namespace rayloc {
namespace {

// A cube that a root's queries ask more often than this is refined: that costs (85 us) as much as
// so many more queries save (18 us each).
constexpr std::size_t kOften = 4;

}  // namespace

ImageTree::ImageTree(const Scene& scene, const Vec3d& root, const TraceOptions& options)
    : ImageTree(scene, std::span(&root, 1), options, grow_image_tree(scene, root, options)) {}

std::optional<ImageTree> ImageTree::shared(const Scene& scene,
                                           std::span<const Vec3d> roots,
                                           const TraceOptions& options) {
  auto grown = grow_exhaustively(scene, roots, options);
  if (!grown) {
    return std::nullopt;
  }
  return ImageTree(scene, roots, options, std::move(*grown));
}

ImageTree::ImageTree(const Scene& scene,
                     std::span<const Vec3d> roots,
                     const TraceOptions& options,
                     GrownTree grown)
    : scene_(&scene),
      roots_(roots.begin(), roots.end()),
      margin_(options.softness),
      clear_only_(!options.transmission && options.softness == 0.0),
      generator_(grown.generator),
      nodes_(std::move(grown.nodes)),
      images_(std::move(grown.images)) {
  const auto often = static_cast<std::uint32_t>(kOften * roots.size());
  index_ = std::make_shared<const BeamIndex>(
      std::move(grown.beams),
      roots.front(),
      BeamIndex::Region{scene.bounds_min(), scene.bounds_max(), often});
}

std::size_t ImageTree::bytes() const {
  return nodes_.capacity() * sizeof(ImageNode) + images_.capacity() * sizeof(Image) +
         index_->bytes();
}

bool ImageTree::back_trace(std::size_t root,
                           std::uint32_t leaf,
                           const Vec3d& target,
                           SpecularChain& chain) const {
  chain.surfaces.clear();
  chain.points.clear();
  if ((nodes_[leaf].roots >> root & 1U) == 0) {
    return false;
  }
  Vec3d point = target;
  for (std::uint32_t i = leaf; i != kRootNode; i = nodes_[i].parent) {
    const std::uint32_t number = nodes_[i].surface;
    const Image& image = images_[i * roots_.size() + root];
    const Surface& surface = scene_->surfaces()[number];
    const double here = distance(surface.plane(), point);
    // The point must be in front of the mirror: on the other side than the image.
    if (image.distance < 0.0 ? here < kMinPlaneDistance : here > -kMinPlaneDistance) {
      return false;
    }
    point = point + (here / (here - image.distance)) * (image.point - point);
    if (!surface.contains(point, margin_)) {
      return false;
    }
    chain.surfaces.push_back(number);
    chain.points.push_back(point);
  }
  std::reverse(chain.surfaces.begin(), chain.surfaces.end());
  std::reverse(chain.points.begin(), chain.points.end());
  return true;
}

bool ImageTree::is_clear(std::size_t root, const SpecularChain& chain, const Vec3d& target) const {
  Segment segment{roots_[root], roots_[root], kNoSurface, kNoSurface};
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

bool ImageTree::is_direct(std::size_t root, const Vec3d& target) const {
  return norm(target - roots_[root]) > kMinPlaneDistance &&
         (!clear_only_ || is_clear(root, {}, target));
}

std::vector<std::uint32_t> ImageTree::candidates(const Vec3d& target) const {
  std::vector<std::uint32_t> nodes;
  const BlockedChains blocked(*scene_, nodes_, images_, roots_);
  index_->find(target, nodes, [&](std::uint32_t node, const CubeRegion& region) {
    return clear_only_ && blocked.holds(node, region);
  });
  return nodes;
}

std::size_t ImageTree::chains_to(const Vec3d& target, std::vector<SpecularChain>& chains) const {
  std::size_t count = 0;
  visit_chains(0, target, [&](const SpecularChain& chain) {
    if (count == chains.size()) {
      chains.emplace_back();
    }
    chains[count++] = chain;
  });
  return count;
}

}  // namespace rayloc
