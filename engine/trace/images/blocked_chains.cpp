#include "engine/trace/images/blocked_chains.h"

#include <algorithm>
#include <optional>

#include "engine/trace/images/beam.h"
#include "engine/trace/images/beam_shadow.h"

namespace rayloc {
namespace {

// Inside all limits by this margin, rounding changes nothing [m].
constexpr double kCertainInside = 1e-6;

// Intersection of the line from `point` to the image of a mirror with the mirror; nothing when the
// point is not certainly in front.
std::optional<Vec3d> reflection(const Image& image,
                                const Plane<double>& plane,
                                const Vec3d& point) {
  const double here = distance(plane, point);
  if (image.distance < 0.0 ? here < kCertainInside : here > -kCertainInside) {
    return std::nullopt;
  }
  return point + (here / (here - image.distance)) * (image.point - point);
}

}  // namespace

bool BlockedChains::holds(std::uint32_t leaf, const CubeRegion& region) const {
  for (std::size_t root = 0; root < roots_.size(); ++root) {
    const bool is_used = (nodes_[leaf].roots >> root & 1U) != 0;
    if (is_used && !holds(root, leaf, region)) {
      return false;
    }
  }
  return true;
}

bool BlockedChains::holds(std::size_t root, std::uint32_t leaf, const CubeRegion& region) const {
  Bundle to{region.centre, {}, kNoSurface};
  for (std::size_t i = 0; i < kCorners; ++i) {
    to.corners[i] = region.centre + Vec3d{(i & 1U) != 0 ? region.half : -region.half,
                                          (i & 2U) != 0 ? region.half : -region.half,
                                          (i & 4U) != 0 ? region.half : -region.half};
  }
  for (std::uint32_t i = leaf; i != kRootNode; i = nodes_[i].parent) {
    const Image& image = images_[i * roots_.size() + root];
    const Plane<double>& plane = scene_.surfaces()[nodes_[i].surface].plane();
    Bundle from{{}, {}, nodes_[i].surface};
    const auto middle = reflection(image, plane, to.middle);
    if (!middle) {
      return false;
    }
    from.middle = *middle;
    for (std::size_t k = 0; k < kCorners; ++k) {
      const auto corner = reflection(image, plane, to.corners[k]);
      if (!corner) {
        return false;
      }
      from.corners[k] = *corner;
    }
    if (is_blocked(i, from.middle, image.point, to)) {
      return true;
    }
    to = from;
  }
  return is_blocked(kRootNode, roots_[root], roots_[root], to);
}

bool BlockedChains::is_blocked(std::uint32_t node,
                               const Vec3d& from,
                               const Vec3d& apex,
                               const Bundle& to) const {
  std::uint32_t from_surface = kNoSurface;
  Plane<double> front;
  if (node != kRootNode) {
    from_surface = nodes_[node].surface;
    front = facing_away(scene_.surfaces()[from_surface].plane(), apex);
  }
  const BeamShadow shadow(apex, node == kRootNode ? nullptr : &front, kCertainInside);
  // A surface that blocks all paths also blocks the middle one.
  std::vector<Crossing> crossings;
  scene_.crossings({from, to.middle, from_surface, to.surface}, crossings);
  return std::any_of(crossings.begin(), crossings.end(), [&](const Crossing& crossing) {
    return shadow.hides(scene_.surfaces()[crossing.surface], to.corners);
  });
}

}  // namespace rayloc
