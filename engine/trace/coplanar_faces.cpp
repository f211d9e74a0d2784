#include "engine/trace/coplanar_faces.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rayloc {
namespace {

// Faces nearer to each other than this coincide [m].
constexpr double kSamePlane = 1e-9;
// The least cosine between normals of parallel faces, chosen: rounding.
constexpr double kParallel = 1.0 - 1e-12;
constexpr double kLargestTilt = 1.5e-6;  // [rad], acos(kParallel)

struct Box {
  Vec3d lower;
  Vec3d upper;
};

Box box_around(const Surface& surface, double margin) {
  const Vec3d grow{margin, margin, margin};
  Box box{surface.outline().front(), surface.outline().front()};
  for (const Vec3d& p : surface.outline()) {
    box.lower = {
        std::min(box.lower.x, p.x), std::min(box.lower.y, p.y), std::min(box.lower.z, p.z)};
    box.upper = {
        std::max(box.upper.x, p.x), std::max(box.upper.y, p.y), std::max(box.upper.z, p.z)};
  }
  return {box.lower - grow, box.upper + grow};
}

bool overlap(const Box& a, const Box& b) {
  return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y &&
         b.lower.y <= a.upper.y && a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
}

// Compared at the faces, not at the world's origin, which may be far away.
bool are_coplanar(const Surface& a, const Surface& b) {
  return std::abs(dot(a.plane().normal, b.plane().normal)) > kParallel &&
         std::all_of(b.outline().begin(), b.outline().end(), [&](const Vec3d& corner) {
           return std::abs(distance(a.plane(), corner)) < kSamePlane;
         });
}

bool is_closed(const Scene& scene, std::uint32_t surface) {
  const Scene::SurfaceOwner& owner = scene.owner(surface);
  return owner.one_facing && scene.solid(owner.object).shells > 0;
}

Vec3d outwards(const Scene& scene, std::uint32_t surface) {
  return static_cast<double>(scene.solid(scene.owner(surface).object).orientation) *
         scene.surfaces()[surface].plane().normal;
}

// CoplanarFace::side of `a` at `b`.
int side_of(const Scene& scene, std::uint32_t a, std::uint32_t b) {
  const Surface& face = scene.surfaces()[a];
  const Surface& other = scene.surfaces()[b];
  const bool a_is_closed = is_closed(scene, a);
  const bool b_is_closed = is_closed(scene, b);
  Vec3d towards = a < b ? face.plane().normal : -other.plane().normal;
  if (a_is_closed && b_is_closed && dot(outwards(scene, a), outwards(scene, b)) > 0.0) {
    const bool a_is_outside = face.area() > other.area() || (face.area() == other.area() && a < b);
    towards = a_is_outside ? outwards(scene, a) : -outwards(scene, a);
  } else if (a_is_closed) {
    towards = -outwards(scene, a);
  } else if (b_is_closed) {
    towards = outwards(scene, b);
  }
  return dot(towards, other.plane().normal) > 0.0 ? 1 : -1;
}

}  // namespace

std::vector<std::vector<CoplanarFace>> find_coplanar_faces(const Scene& scene,
                                                           const TraceOptions& options) {
  const auto& surfaces = scene.surfaces();
  std::vector<Box> boxes;
  boxes.reserve(surfaces.size());
  for (const Surface& surface : surfaces) {
    boxes.push_back(box_around(surface, options.softness + kSamePlane));
  }
  // Faces in one plane have equal distances from any point, up to the difference of their normals,
  // so only neighbours need be compared.
  const Vec3d centre = 0.5 * (scene.bounds_min() + scene.bounds_max());
  const double slack =
      kSamePlane + kLargestTilt * 0.5 * norm(scene.bounds_max() - scene.bounds_min());
  std::vector<std::uint32_t> order(surfaces.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto away = [&](std::uint32_t i) {
    return std::abs(distance(surfaces[i].plane(), centre));
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    return away(i) < away(j);
  });
  std::vector<std::vector<CoplanarFace>> found(surfaces.size());
  for (std::size_t first = 0; first < order.size(); ++first) {
    const std::uint32_t i = order[first];
    for (std::size_t second = first + 1;
         second < order.size() && away(order[second]) - away(i) <= slack;
         ++second) {
      const std::uint32_t j = order[second];
      if (scene.owner(i).object != scene.owner(j).object && overlap(boxes[i], boxes[j]) &&
          (are_coplanar(surfaces[i], surfaces[j]) || are_coplanar(surfaces[j], surfaces[i]))) {
        found[i].push_back({j, side_of(scene, j, i)});
        found[j].push_back({i, side_of(scene, i, j)});
      }
    }
  }
  for (auto& list : found) {
    std::sort(list.begin(), list.end(), [](const CoplanarFace& a, const CoplanarFace& b) {
      return a.surface < b.surface;
    });
  }
  return found;
}

}  // namespace rayloc
