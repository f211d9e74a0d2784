#include "engine/trace/image_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/trace/image_method.h"

namespace rayloc {
namespace {

// Closer to a mirror's plane than this, a point is on it and has no reflection there [m].
constexpr double kOnPlane = 1e-9;
// A beam is kept this much wider than it is, so that rounding cannot cut a path off [m].
constexpr double kBeamMargin = 1e-7;
// Winding numbers closer than this to a whole number are that number.
constexpr double kWindingTolerance = 0.01;

using Polygon = std::vector<Vec3d>;

bool is_outside(const Plane<double>& plane, const Polygon& polygon) {
  return std::all_of(polygon.begin(), polygon.end(), [&](const Vec3d& corner) {
    return distance(plane, corner) < -kBeamMargin;
  });
}

// Cuts off what lies behind the plane (Sutherland and Hodgman).
void clip(const Plane<double>& plane, Polygon& polygon, Polygon& scratch) {
  scratch.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d& p = polygon[i];
    const Vec3d& q = polygon[(i + 1) % polygon.size()];
    const double dp = distance(plane, p) + kBeamMargin;
    const double dq = distance(plane, q) + kBeamMargin;
    if (dp >= 0.0) {
      scratch.push_back(p);
    }
    if ((dp >= 0.0) != (dq >= 0.0)) {
      scratch.push_back(p + (dp / (dp - dq)) * (q - p));
    }
  }
  polygon.swap(scratch);
}

// A convex outline, anticlockwise seen from where `normal` points to, with its edges moved
// outwards.
Polygon grown(const Polygon& outline, const Vec3d& normal, double margin) {
  if (margin == 0.0) {
    return outline;
  }
  const std::size_t n = outline.size();
  Polygon result;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d before = cross(normalized(outline[i] - outline[(i + n - 1) % n]), normal);
    const Vec3d after = cross(normalized(outline[(i + 1) % n] - outline[i]), normal);
    result.push_back(outline[i] + (margin / (1.0 + dot(before, after))) * (before + after));
  }
  return result;
}

// The planes through `apex` and the sides of `window`, looking inwards. A side seen end on bounds
// nothing that rounding could not move, so it is left out.
std::vector<Plane<double>> beam_planes(const Vec3d& apex, const Polygon& window) {
  Vec3d centre;
  for (const Vec3d& corner : window) {
    centre = centre + (1.0 / static_cast<double>(window.size())) * corner;
  }
  std::vector<Plane<double>> planes;
  for (std::size_t i = 0; i < window.size(); ++i) {
    const Vec3d a = window[i] - apex;
    const Vec3d b = window[(i + 1) % window.size()] - apex;
    const Vec3d across = cross(a, b);
    const double size = norm(across);
    if (!(size > kBeamMargin * (norm(a) + norm(b)))) {
      continue;
    }
    const Vec3d normal = (1.0 / size) * across;
    const Plane<double> plane{normal, dot(normal, apex)};
    const double inwards = distance(plane, centre);
    if (inwards > kBeamMargin) {
      planes.push_back(plane);
    } else if (inwards < -kBeamMargin) {
      planes.push_back({-normal, -plane.offset});
    }
  }
  return planes;
}

}  // namespace

// Grows the tree level by level; needed only while it is built.
class ImageTree::Builder {
 public:
  Builder(const Scene& scene, const Vec3d& root, const TraceOptions& options) : scene_(scene) {
    side_.reserve(scene.surfaces().size());
    std::vector<int> object_side;
    for (std::uint32_t i = 0; i < scene.objects().size(); ++i) {
      object_side.push_back(
          options.transmission ? 0 : lit_side(scene.solid(i), scene.objects()[i].mesh, root));
    }
    for (const Surface& surface : scene.surfaces()) {
      outlines_.push_back(grown(surface.outline(), surface.plane().normal, options.softness));
    }
    for (std::uint32_t i = 0; i < scene.surfaces().size(); ++i) {
      const Scene::SurfaceOwner& owner = scene.owner(i);
      side_.push_back(owner.one_facing ? object_side[owner.object] : 0);
    }
  }

  std::vector<Node> grow(const Vec3d& root, int max_depth) {
    std::vector<Node> nodes;
    if (max_depth == 0) {
      return nodes;
    }
    add_children(nodes, kRoot, root, nullptr);
    std::size_t first = 0;
    for (int depth = 1; depth < max_depth; ++depth) {
      const std::size_t end = nodes.size();
      const std::vector<Polygon> windows = std::exchange(windows_, {});
      for (std::size_t i = first; i < end; ++i) {
        add_children(nodes, static_cast<std::uint32_t>(i), nodes[i].image, &windows[i - first]);
      }
      first = end;
    }
    return nodes;
  }

 private:
  // Which side of an object's faces waves from `root` can meet: that of the normal (+1), the other
  // (-1), or both (0).
  static int lit_side(const Solid& solid, const Mesh& mesh, const Vec3d& root) {
    if (solid.shells == 0) {
      return 0;
    }
    const double around = solid.orientation * winding_number(mesh, root);
    if (std::abs(around) < kWindingTolerance) {
      return solid.orientation;
    }
    const bool inside_single = solid.shells == 1 && std::abs(around - 1.0) < kWindingTolerance;
    return inside_single ? -solid.orientation : 0;
  }

  // `window`: the part of the parent's surface that the chain so far lights; nullptr for the root.
  void add_children(std::vector<Node>& nodes,
                    std::uint32_t parent,
                    Vec3d image,  // by value: `nodes` grows
                    const Polygon* window) {
    std::uint32_t mirror_surface = kNoSurface;
    std::vector<Plane<double>> bounds;
    if (window != nullptr) {
      mirror_surface = nodes[parent].surface;
      bounds = beam_planes(image, *window);
      // In front of the mirror, where the image is not.
      const Plane<double>& plane = scene_.surfaces()[mirror_surface].plane();
      bounds.push_back(
          nodes[parent].image_distance < 0.0 ? plane : Plane<double>{-plane.normal, -plane.offset});
    }
    for (std::uint32_t i = 0; i < scene_.surfaces().size(); ++i) {
      const Plane<double>& plane = scene_.surfaces()[i].plane();
      const double d = distance(plane, image);
      if (i == mirror_surface || std::abs(d) < kOnPlane || d * side_[i] < 0.0 ||
          !light(i, plane, d, window, bounds)) {
        continue;
      }
      nodes.push_back({mirror(plane, image), -d, i, parent});
      windows_.push_back(polygon_);
    }
  }

  // Whether the beam reaches surface `i` from the side where its apex is; polygon_ is then the part
  // that it lights.
  bool light(std::uint32_t i,
             const Plane<double>& plane,
             double apex_distance,
             const Polygon* window,
             const std::vector<Plane<double>>& bounds) {
    const Polygon& outline = outlines_[i];
    const Plane<double> front =
        apex_distance > 0.0 ? plane : Plane<double>{-plane.normal, -plane.offset};
    if (window != nullptr && is_outside(front, *window)) {
      return false;
    }
    for (const Plane<double>& bound : bounds) {
      if (is_outside(bound, outline)) {
        return false;
      }
    }
    polygon_ = outline;
    for (const Plane<double>& bound : bounds) {
      clip(bound, polygon_, scratch_);
      if (polygon_.size() < 3) {
        return false;
      }
    }
    return true;
  }

  const Scene& scene_;
  std::vector<int> side_;          // of each surface, as lit_side()
  std::vector<Polygon> outlines_;  // of each surface
  std::vector<Polygon> windows_;   // of the nodes of the newest level
  Polygon polygon_;
  Polygon scratch_;
};

ImageTree::ImageTree(const Scene& scene, const Vec3d& root, const TraceOptions& options)
    : scene_(&scene),
      root_(root),
      margin_(options.softness),
      clear_only_(!options.transmission && options.softness == 0.0),
      nodes_(Builder(scene, root, options).grow(root, options.max_depth)) {}

bool ImageTree::back_trace(std::uint32_t leaf, const Vec3d& target, SpecularChain& chain) const {
  chain.surfaces.clear();
  chain.points.clear();
  Vec3d point = target;
  for (std::uint32_t i = leaf; i != kRoot; i = nodes_[i].parent) {
    const Node& node = nodes_[i];
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

std::size_t ImageTree::chains_to(const Vec3d& target, std::vector<SpecularChain>& chains) const {
  std::size_t count = 0;
  const auto slot = [&]() -> SpecularChain& {
    if (count == chains.size()) {
      chains.emplace_back();
    }
    return chains[count];
  };
  SpecularChain& direct = slot();
  direct.surfaces.clear();
  direct.points.clear();
  if (norm(target - root_) > kOnPlane && (!clear_only_ || is_clear(direct, target))) {
    ++count;
  }
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    SpecularChain& chain = slot();
    if (back_trace(i, target, chain) && (!clear_only_ || is_clear(chain, target))) {
      ++count;
    }
  }
  return count;
}

}  // namespace rayloc
