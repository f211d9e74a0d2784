#include "daemon/site/scene/surface_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>
#include <vector>

#include "daemon/site/scene/surface_triangles.h"
#include "engine/scene/bounds.h"
#include "engine/scene/overlap/disjoint_triangles.h"

namespace rayloc {
namespace {

constexpr double kMinOverlapArea = 1e-6;    // [m^2]
constexpr double kSamePlane = 2e-5;         // [m]: two surfaces, each within kCoplanarTolerance
constexpr double kParallel = 1.0 - 5e-7;    // cos(angle), as surface.cpp groups triangles
constexpr double kSomethingBeyond = 0.001;  // [m]

using Polygon = std::vector<Vec3d>;

// The part of a convex polygon on the inner side of the edge a-b (Sutherland and Hodgman).
Polygon clip(const Polygon& polygon, const Vec3d& a, const Vec3d& b, const Vec3d& normal) {
  const Vec3d inwards = cross(normal, b - a);
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d& p = polygon[i];
    const Vec3d& q = polygon[(i + 1) % polygon.size()];
    const double from = dot(inwards, p - a);
    const double to = dot(inwards, q - a);
    if (from >= 0.0) {
      kept.push_back(p);
    }
    if ((from > 0.0 && to < 0.0) || (from < 0.0 && to > 0.0)) {
      kept.push_back(p + (from / (from - to)) * (q - p));
    }
  }
  return kept;
}

double area(const Polygon& polygon) {
  Vec3d twice;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    twice = twice + cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  }
  return 0.5 * norm(twice);
}

double common_area(const Triangle& s, const Triangle& t) {
  const Vec3d normal = cross(t[1] - t[0], t[2] - t[0]);  // t runs anticlockwise around it
  Polygon polygon(s.begin(), s.end());
  for (std::size_t i = 0; i < 3 && !polygon.empty(); ++i) {
    polygon = clip(polygon, t.at(i), t.at((i + 1) % 3), normal);
  }
  return area(polygon);
}

// Removes overlapping parts of the same surface, so that no area is counted twice.
std::vector<Triangle> covered_once(const Surface& surface, std::vector<Triangle> triangles) {
  std::vector<Triangle2> flat;
  for (const Triangle& t : triangles) {
    Triangle2& corners = flat.emplace_back();
    for (std::size_t k = 0; k < t.size(); ++k) {
      const Vec3d from = t.at(k) - surface.origin();
      corners.at(k) = {dot(surface.u_axis(), from), dot(surface.v_axis(), from)};
    }
  }
  const std::vector<Triangle2> disjoint = disjoint_triangles(flat, kCoplanarTolerance);
  if (disjoint == flat) {
    return triangles;
  }
  triangles.clear();
  for (const Triangle2& t : disjoint) {
    Triangle& corners = triangles.emplace_back();
    for (std::size_t k = 0; k < t.size(); ++k) {
      corners.at(k) =
          surface.origin() + t.at(k).u * surface.u_axis() + t.at(k).v * surface.v_axis();
    }
  }
  return triangles;
}

// A surface with its plane oriented so that parallel planes have parallel normals.
struct Candidate {
  std::uint32_t surface;
  Plane<double> plane;
  bool seen_from_above;  // visible from the normal's side
  bool seen_from_below;
  Bounds bounds;
};

Candidate candidate_of(const Scene& scene, std::uint32_t index) {
  const Surface& surface = scene.surfaces()[index];
  Candidate out{index, surface.plane(), true, true, {}};
  const Vec3d& n = out.plane.normal;
  // Any direction to which no wall of a room is likely to be parallel.
  const bool rotated = dot(n, Vec3d{0.87, 0.41, 0.27}) < 0.0;
  const Scene::SurfaceOwner& owner = scene.owner(index);
  const Solid& solid = scene.solid(owner.object);
  if (solid.shells > 0 && owner.one_facing) {
    const bool outwards_is_above = (solid.orientation > 0) != rotated;
    out.seen_from_above = outwards_is_above;
    out.seen_from_below = !outwards_is_above;
  }
  if (rotated) {
    out.plane = {-n, -out.plane.offset};
  }
  for (const Vec3d& p : surface.outline()) {
    out.bounds.include(p);
  }
  return out;
}

bool boxes_touch(const Bounds& a, const Bounds& b) {
  const Vec3d slack{kSamePlane, kSamePlane, kSamePlane};
  const Vec3d gap_ab = a.lower - (b.upper + slack);
  const Vec3d gap_ba = b.lower - (a.upper + slack);
  return gap_ab.x <= 0.0 && gap_ba.x <= 0.0 && gap_ab.y <= 0.0 && gap_ba.y <= 0.0 &&
         gap_ab.z <= 0.0 && gap_ba.z <= 0.0;
}

bool same_plane(const Scene& scene, const Candidate& a, const Candidate& b) {
  const auto& outline = scene.surfaces()[b.surface].outline();
  return dot(a.plane.normal, b.plane.normal) >= kParallel &&
         std::all_of(outline.begin(), outline.end(), [&](const Vec3d& p) {
           return std::abs(distance(a.plane, p)) <= kSamePlane;
         });
}

bool seen_together(const Scene& scene, const Candidate& a, const Candidate& b) {
  const Vec3d low = scene.bounds_min();
  const Vec3d high = scene.bounds_max();
  bool above = false;
  bool below = false;
  for (unsigned i = 0; i < 8; ++i) {
    const Vec3d corner{(i & 1U) != 0 ? high.x : low.x,
                       (i & 2U) != 0 ? high.y : low.y,
                       (i & 4U) != 0 ? high.z : low.z};
    above = above || distance(a.plane, corner) > kSomethingBeyond;
    below = below || distance(a.plane, corner) < -kSomethingBeyond;
  }
  return (above && a.seen_from_above && b.seen_from_above) ||
         (below && a.seen_from_below && b.seen_from_below);
}

}  // namespace

std::vector<SurfaceOverlap> find_overlaps(const Scene& scene) {
  std::vector<Candidate> candidates;
  for (std::uint32_t i = 0; i < scene.surfaces().size(); ++i) {
    candidates.push_back(candidate_of(scene, i));
  }
  // Sorted by one bound, so that only neighbours are compared.
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.bounds.lower.x, a.surface) < std::tie(b.bounds.lower.x, b.surface);
  });
  auto triangles = surface_triangles(scene);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    triangles[i] = covered_once(scene.surfaces()[i], std::move(triangles[i]));
  }
  std::vector<SurfaceOverlap> overlaps;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& a = candidates[i];
    for (std::size_t j = i + 1;
         j < candidates.size() && candidates[j].bounds.lower.x <= a.bounds.upper.x + kSamePlane;
         ++j) {
      const Candidate& b = candidates[j];
      if (scene.owner(a.surface).object == scene.owner(b.surface).object ||
          !boxes_touch(a.bounds, b.bounds) || !same_plane(scene, a, b)) {
        continue;
      }
      double common = 0.0;
      for (const Triangle& s : triangles[a.surface]) {
        for (const Triangle& t : triangles[b.surface]) {
          common += common_area(s, t);
        }
      }
      if (common > kMinOverlapArea) {
        overlaps.push_back({std::min(a.surface, b.surface),
                            std::max(a.surface, b.surface),
                            common,
                            seen_together(scene, a, b)});
      }
    }
  }
  std::sort(overlaps.begin(), overlaps.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first, a.second) < std::tie(b.first, b.second);
  });
  return overlaps;
}

}  // namespace rayloc
