#include "tests/bench/plain_image_method.h"

#include <array>
#include <cmath>

#include "engine/base/check.h"
#include "engine/trace/image_method.h"

namespace rayloc::bench {
namespace {

constexpr double kOnPlane = 1e-9;  // [m]

}  // namespace

struct PlainImageMethod::Chain {
  Vec3d from, to;
  std::array<std::uint32_t, kMaxDepth> surface;
  std::array<Vec3d, kMaxDepth + 1> image;  // of `from`, by so many mirrors
};

PlainImageMethod::PlainImageMethod(const Scene& scene, int max_depth)
    : scene_(scene), max_depth_(max_depth) {
  RAYLOC_CHECK(max_depth >= 0 && max_depth <= kMaxDepth);
  for (std::uint32_t i = 0; i < scene.surfaces().size(); ++i) {
    const Scene::SurfaceOwner& owner = scene.owner(i);
    const Solid& solid = scene.solid(owner.object);
    side_.push_back(owner.one_facing && solid.shells > 0 ? solid.orientation : 0.0);
  }
}

std::size_t PlainImageMethod::count_paths(const Vec3d& from, const Vec3d& to) const {
  Chain chain{from, to, {}, {}};
  chain.image[0] = from;
  return follow(chain, 0);
}

// Paths over the first `depth` mirrors of the chain and any after them.
std::size_t PlainImageMethod::follow(Chain& chain, int depth) const {
  const auto last = static_cast<std::size_t>(depth);
  std::size_t count = is_path(chain, depth) ? 1 : 0;
  if (depth == max_depth_) {
    return count;
  }
  for (std::uint32_t i = 0; i < side_.size(); ++i) {
    const Plane<double>& plane = scene_.surfaces()[i].plane();
    const double here = distance(plane, chain.image[last]);
    if (std::abs(here) < kOnPlane || here * side_[i] < 0.0 ||
        (depth > 0 && i == chain.surface[last - 1])) {
      continue;
    }
    chain.surface[last] = i;
    chain.image[last + 1] = mirror(plane, chain.image[last]);
    count += follow(chain, depth + 1);
  }
  return count;
}

bool PlainImageMethod::is_path(const Chain& chain, int depth) const {
  std::array<Vec3d, kMaxDepth> points;
  Vec3d point = chain.to;
  for (auto i = static_cast<std::size_t>(depth); i-- > 0;) {
    const Surface& surface = scene_.surfaces()[chain.surface[i]];
    const double here = distance(surface.plane(), point);
    const double behind = distance(surface.plane(), chain.image[i + 1]);
    if (behind < 0.0 ? here < kOnPlane : here > -kOnPlane) {
      return false;
    }
    point = point + (here / (here - behind)) * (chain.image[i + 1] - point);
    if (!surface.contains(point)) {
      return false;
    }
    points[i] = point;
  }
  Segment segment{chain.from, chain.from, kNoSurface, kNoSurface};
  for (std::size_t i = 0; i <= static_cast<std::size_t>(depth); ++i) {
    const bool last = i == static_cast<std::size_t>(depth);
    segment.to = last ? chain.to : points[i];
    segment.to_surface = last ? kNoSurface : chain.surface[i];
    if (scene_.is_blocked(segment)) {
      return false;
    }
    segment.from = segment.to;
    segment.from_surface = segment.to_surface;
  }
  return true;
}

}  // namespace rayloc::bench
