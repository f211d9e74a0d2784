#include "daemon/site/import/planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <utility>

#include <Eigen/Eigenvalues>

#include "daemon/site/import/coverage.h"

namespace rayloc {
namespace {

constexpr std::size_t kDenseTriangles = 1000;  // chosen; more than are drawn by hand
constexpr std::size_t kDenseInScan = 48;       // chosen: four times a box
constexpr double kDenseArea = 0.01;            // [m^2] per triangle, chosen
constexpr double kSmoothing = 0.12;      // [m], chosen: ten times the roughness of a phone's scan
constexpr double kMinCosine = 0.85;      // in neighbourhoods of one plane, chosen: 32 degrees
constexpr double kSeedCoherence = 0.85;  // share of the median, chosen: across a right angle 0.71
constexpr double kMinTolerance = 0.004;  // [m], chosen
constexpr double kMaxTolerance = 0.05;   // [m], chosen; more joins a wall and objects at it
constexpr double kMinRegion = 0.03;      // [m^2], chosen; smaller areas reflect little
constexpr double kSnap = 0.08;           // [m], chosen: an edge this close ends at the plane
constexpr double kMinWidth = 0.01;       // [m], chosen; narrower strips are rounding of the outline
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

struct Triangle {
  Vec3d middle;
  Vec3d area_vector;  // [m^2]
  double area = 0.0;
  Vec3d facing;            // normal of the neighbourhood
  double coherence = 0.0;  // share of the neighbourhood's area with that normal
  std::array<std::uint32_t, 3> neighbours{kNone, kNone, kNone};
};

// Weighted sums of points, for the fit of a plane through them.
class PlaneFit {
 public:
  void add(const Vec3d& p, double weight) {
    const Eigen::Vector3d v(p.x, p.y, p.z);
    weight_ += weight;
    sum_ += weight * v;
    squares_ += weight * v * v.transpose();
  }
  struct Result {
    Vec3d normal, middle;
    double error = 0.0;
  };
  Result solve() const {
    const Eigen::Vector3d middle = sum_ / weight_;
    const Eigen::Matrix3d spread = squares_ / weight_ - middle * middle.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
    const Eigen::Vector3d normal = solver.eigenvectors().col(0);
    return {{normal[0], normal[1], normal[2]},
            {middle[0], middle[1], middle[2]},
            std::sqrt(std::max(0.0, solver.eigenvalues()[0]))};
  }

 private:
  double weight_ = 0.0;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares_ = Eigen::Matrix3d::Zero();
};

std::vector<Triangle> triangles_of(const Mesh& mesh) {
  std::vector<Triangle> triangles(mesh.triangles.size());
  std::unordered_map<std::uint64_t, std::pair<std::uint32_t, int>> open_edges;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const auto& corners = mesh.triangles[i];
    const Vec3d& a = mesh.vertices[corners[0]];
    const Vec3d& b = mesh.vertices[corners[1]];
    const Vec3d& c = mesh.vertices[corners[2]];
    Triangle& triangle = triangles[i];
    triangle.middle = (1.0 / 3.0) * (a + b + c);
    triangle.area_vector = 0.5 * cross(b - a, c - a);
    triangle.area = norm(triangle.area_vector);
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t from = corners.at(static_cast<std::size_t>(k));
      const std::uint64_t to = corners.at(static_cast<std::size_t>((k + 1) % 3));
      const std::uint64_t key = (std::min(from, to) << 32U) | std::max(from, to);
      const auto [found, added] = open_edges.try_emplace(key, i, k);
      if (!added) {
        const auto [other, side] = found->second;
        triangle.neighbours.at(static_cast<std::size_t>(k)) = other;
        triangles[other].neighbours.at(static_cast<std::size_t>(side)) = i;
      }
    }
  }
  return triangles;
}

// Normal of the neighbourhood of each triangle: noise tilts a small triangle by tens of degrees,
// and its neighbours in the opposite direction.
void smooth(std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> seen(triangles.size(), kNone);
  std::vector<std::uint32_t> queue;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    queue.assign(1, i);
    seen[i] = i;
    Vec3d sum;
    double area = 0.0;
    for (std::size_t at = 0; at < queue.size(); ++at) {
      const Triangle& one = triangles[queue[at]];
      sum = sum + one.area_vector;
      area += one.area;
      for (const std::uint32_t next : one.neighbours) {
        if (next != kNone && seen[next] != i &&
            norm(triangles[next].middle - triangles[i].middle) < kSmoothing) {
          seen[next] = i;
          queue.push_back(next);
        }
      }
    }
    const double length = norm(sum);
    triangles[i].facing = length > 0.0 ? (1.0 / length) * sum : Vec3d{0, 0, 1};
    triangles[i].coherence = area > 0.0 ? length / area : 0.0;
  }
}

// Three times the distance of triangle centres from the plane of their neighbourhood: the median
// over some hundred neighbourhoods, most of which are well inside a plane.
double roughness(const std::vector<Triangle>& triangles) {
  std::vector<double> errors;
  const std::size_t step = std::max<std::size_t>(1, triangles.size() / 400);
  for (std::size_t i = 0; i < triangles.size(); i += step) {
    std::vector<std::uint32_t> near{static_cast<std::uint32_t>(i)};
    std::unordered_map<std::uint32_t, bool> seen{{near[0], true}};
    PlaneFit fit;
    for (std::size_t at = 0; at < near.size(); ++at) {
      const Triangle& one = triangles[near[at]];
      fit.add(one.middle, one.area);
      for (const std::uint32_t next : one.neighbours) {
        if (next != kNone && norm(triangles[next].middle - triangles[i].middle) < kSmoothing &&
            dot(triangles[next].facing, triangles[i].facing) > kMinCosine &&
            seen.try_emplace(next, true).second) {
          near.push_back(next);
        }
      }
    }
    if (near.size() >= 6) {
      errors.push_back(fit.solve().error);
    }
  }
  if (errors.empty()) {
    return kMinTolerance;
  }
  std::nth_element(errors.begin(),
                   errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                   errors.end());
  return 3.0 * errors[errors.size() / 2];
}

struct Region {
  std::vector<std::uint32_t> triangles;
  PlaneFit::Result plane;
  double area = 0.0;
};

Region grow(std::uint32_t seed,
            double tolerance,
            const std::vector<Triangle>& triangles,
            std::vector<bool>& taken) {
  Region region;
  region.plane = {triangles[seed].facing, triangles[seed].middle, 0.0};
  PlaneFit fit;
  std::deque<std::uint32_t> queue{seed};
  taken[seed] = true;
  double fitted_area = 0.0;
  while (!queue.empty()) {
    const std::uint32_t i = queue.front();
    queue.pop_front();
    const Triangle& one = triangles[i];
    // A region smaller than a neighbourhood uses the plane of its seed, with a larger tolerance.
    const double reach = region.area < kMinRegion ? 2.0 * tolerance : tolerance;
    if (std::abs(dot(region.plane.normal, one.middle - region.plane.middle)) > reach ||
        dot(region.plane.normal, one.facing) < kMinCosine) {
      taken[i] = false;
      continue;
    }
    region.triangles.push_back(i);
    region.area += one.area;
    fit.add(one.middle, one.area);
    if (region.area > kMinRegion && region.area > 1.1 * fitted_area) {
      const Vec3d facing = region.plane.normal;
      region.plane = fit.solve();
      if (dot(facing, region.plane.normal) < 0.0) {
        region.plane.normal = -region.plane.normal;
      }
      fitted_area = region.area;
    }
    for (const std::uint32_t next : one.neighbours) {
      if (next != kNone && !taken[next]) {
        taken[next] = true;
        queue.push_back(next);
      }
    }
  }
  if (region.area > 0.0 && region.triangles.size() > 3) {
    const Vec3d facing = region.plane.normal;
    region.plane = fit.solve();
    if (dot(facing, region.plane.normal) < 0.0) {
      region.plane.normal = -region.plane.normal;
    }
  }
  return region;
}

// Merges pieces of one plane that were separated by noise.
void merge(double tolerance, const std::vector<Triangle>& triangles, std::vector<Region>& regions) {
  for (std::size_t i = 0; i < regions.size(); ++i) {
    for (std::size_t j = i + 1; j < regions.size();) {
      const PlaneFit::Result& a = regions[i].plane;
      const PlaneFit::Result& b = regions[j].plane;
      constexpr double kParallel = 0.985;  // cosine, chosen: 10 degrees, for small regions
      if (dot(a.normal, b.normal) < kParallel ||
          std::abs(dot(a.normal, b.middle - a.middle)) > tolerance) {
        ++j;
        continue;
      }
      Region& whole = regions[i];
      whole.triangles.insert(
          whole.triangles.end(), regions[j].triangles.begin(), regions[j].triangles.end());
      whole.area += regions[j].area;
      PlaneFit fit;
      for (const std::uint32_t triangle : whole.triangles) {
        fit.add(triangles[triangle].middle, triangles[triangle].area);
      }
      const Vec3d facing = whole.plane.normal;
      whole.plane = fit.solve();
      if (dot(facing, whole.plane.normal) < 0.0) {
        whole.plane.normal = -whole.plane.normal;
      }
      regions.erase(regions.begin() + static_cast<std::ptrdiff_t>(j));
    }
  }
}

struct PlaneAxes {
  Vec3d u, v;
};

// Along the sides of the narrowest rectangle around the region; upright planes stay upright.
PlaneAxes axes_of(const Region& region, const std::vector<Triangle>& triangles) {
  const Vec3d& normal = region.plane.normal;
  const Vec3d up{0, 0, 1};
  constexpr double kUpright = 0.3;  // chosen: |z| of the normal below which a surface is a wall
  if (std::abs(normal.z) < kUpright) {
    const Vec3d u = normalized(cross(up, normal));
    return {u, cross(normal, u)};
  }
  const Vec3d first = normalized(cross(normal, Vec3d{0, 1, 0}));
  const Vec3d second = cross(normal, first);
  double least = std::numeric_limits<double>::infinity();
  PlaneAxes best{first, second};
  for (int degree = 0; degree < 90; ++degree) {
    const double angle = degree * 3.14159265358979 / 180.0;
    const Vec3d u = std::cos(angle) * first + std::sin(angle) * second;
    const Vec3d v = cross(normal, u);
    double low_u = 1e30, high_u = -1e30, low_v = 1e30, high_v = -1e30;
    for (const std::uint32_t i : region.triangles) {
      const double a = dot(u, triangles[i].middle);
      const double b = dot(v, triangles[i].middle);
      low_u = std::min(low_u, a);
      high_u = std::max(high_u, a);
      low_v = std::min(low_v, b);
      high_v = std::max(high_v, b);
    }
    const double area = (high_u - low_u) * (high_v - low_v);
    if (area < least) {
      least = area;
      best = {u, v};
    }
  }
  return best;
}

double quantile(std::vector<double> values, double share) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

void add_rectangle(const Coverage::Rectangle& r,
                   const Region& region,
                   const PlaneAxes& axes,
                   Mesh& mesh) {
  if (r.high_u - r.low_u < kMinWidth || r.high_v - r.low_v < kMinWidth) {
    return;
  }
  const double offset = dot(region.plane.normal, region.plane.middle);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const auto& [u, v] : {std::pair{r.low_u, r.low_v},
                             {r.high_u, r.low_v},
                             {r.high_u, r.high_v},
                             {r.low_u, r.high_v}}) {
    mesh.vertices.push_back(u * axes.u + v * axes.v + offset * region.plane.normal);
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

// Snaps an edge near `at` to another plane that crosses this one parallel to an axis.
double snapped(double at,
               const Vec3d& across,
               const Vec3d& point,
               const Region& region,
               const std::vector<Region>& regions) {
  double best = at;
  double nearest = kSnap;
  for (const Region& other : regions) {
    const double steep = dot(across, other.plane.normal);
    constexpr double kSquare = 0.97;  // cosine, chosen: 14 degrees
    if (&other == &region || std::abs(steep) < kSquare) {
      continue;
    }
    const double crossing = at + dot(other.plane.normal, other.plane.middle - point) / steep;
    if (std::abs(crossing - at) < nearest) {
      nearest = std::abs(crossing - at);
      best = crossing;
    }
  }
  return best;
}

ScanPlane plane_of(const Region& region,
                   const std::vector<Triangle>& triangles,
                   const std::vector<Region>& regions) {
  const PlaneAxes axes = axes_of(region, triangles);
  std::vector<double> u, v;
  u.reserve(region.triangles.size());
  v.reserve(region.triangles.size());
  for (const std::uint32_t i : region.triangles) {
    u.push_back(dot(axes.u, triangles[i].middle));
    v.push_back(dot(axes.v, triangles[i].middle));
  }
  // The outermost thousandth is noise.
  constexpr double kOutermost = 0.002;
  Coverage::Rectangle around{quantile(u, kOutermost),
                             quantile(v, kOutermost),
                             quantile(u, 1.0 - kOutermost),
                             quantile(v, 1.0 - kOutermost)};
  const Vec3d& normal = region.plane.normal;
  const auto snap = [&](double& edge, const Vec3d& axis, double middle_u, double middle_v) {
    const double offset = dot(normal, region.plane.middle);
    edge = snapped(
        edge, axis, middle_u * axes.u + middle_v * axes.v + offset * normal, region, regions);
  };
  const double middle_u = 0.5 * (around.low_u + around.high_u);
  const double middle_v = 0.5 * (around.low_v + around.high_v);
  snap(around.low_u, axes.u, around.low_u, middle_v);
  snap(around.high_u, axes.u, around.high_u, middle_v);
  snap(around.low_v, axes.v, middle_u, around.low_v);
  snap(around.high_v, axes.v, middle_u, around.high_v);

  ScanPlane plane{normal, region.plane.middle, region.area, region.plane.error, {}};
  const double whole = (around.high_u - around.low_u) * (around.high_v - around.low_v);
  constexpr double kWhole = 0.85;  // chosen: for a rectangle whose gaps come from the scan
  if (region.area >= kWhole * whole ||
      std::min(around.high_u - around.low_u, around.high_v - around.low_v) < 2.0 * kCell) {
    add_rectangle(around, region, axes, plane.mesh);
    return plane;
  }
  Coverage coverage(around.low_u, around.high_u, around.low_v, around.high_v);
  for (std::size_t k = 0; k < region.triangles.size(); ++k) {
    coverage.add(u[k], v[k], triangles[region.triangles[k]].area);
  }
  for (Coverage::Rectangle piece : coverage.rectangles()) {
    piece.high_u = std::min(piece.high_u, around.high_u);
    piece.high_v = std::min(piece.high_v, around.high_v);
    add_rectangle(piece, region, axes, plane.mesh);
  }
  return plane;
}

}  // namespace

bool is_dense(const Mesh& mesh, bool in_scan) {
  if (mesh.triangles.size() < (in_scan ? kDenseInScan : kDenseTriangles)) {
    return false;
  }
  double area = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3d& a = mesh.vertices[t[0]];
    area += 0.5 * norm(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a));
  }
  return area < kDenseArea * static_cast<double>(mesh.triangles.size());
}

ScanPlanes find_planes(const Mesh& mesh, double tolerance) {
  std::vector<Triangle> triangles = triangles_of(mesh);
  smooth(triangles);
  ScanPlanes found;
  found.tolerance =
      tolerance > 0.0 ? tolerance : std::clamp(roughness(triangles), kMinTolerance, kMaxTolerance);
  std::vector<std::uint32_t> seeds(triangles.size());
  std::iota(seeds.begin(), seeds.end(), 0U);
  std::stable_sort(seeds.begin(), seeds.end(), [&](std::uint32_t a, std::uint32_t b) {
    return triangles[a].coherence > triangles[b].coherence;
  });
  std::vector<bool> taken(triangles.size(), false);
  std::vector<Region> regions;
  for (const Triangle& triangle : triangles) {
    found.area += triangle.area;
  }
  // Across the edge of a box a neighbourhood has an intermediate normal, and is no seed of a plane.
  const double least_coherence =
      seeds.empty() ? 0.0 : kSeedCoherence * triangles[seeds[seeds.size() / 2]].coherence;
  for (const std::uint32_t seed : seeds) {
    if (taken[seed] || triangles[seed].coherence < least_coherence) {
      continue;
    }
    Region region = grow(seed, found.tolerance, triangles, taken);
    taken[seed] = true;
    if (region.area >= kMinRegion) {
      regions.push_back(std::move(region));
    }
  }
  std::stable_sort(regions.begin(), regions.end(), [](const Region& a, const Region& b) {
    return a.area > b.area;
  });
  merge(found.tolerance, triangles, regions);
  for (const Region& region : regions) {
    ScanPlane plane = plane_of(region, triangles, regions);
    if (!plane.mesh.triangles.empty()) {
      found.kept_area += plane.area;
      found.planes.push_back(std::move(plane));
    }
  }
  return found;
}

}  // namespace rayloc
