// planar_surfaces (surface.h): groups the triangles of a mesh into mirrors.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>

#include "engine/scene/surface.h"
#include "engine/scene/unit_vector.h"

namespace rayloc {
namespace {

using Triangle = std::array<Vec3d, 3>;

// Least cosine between normals of coplanar triangles, where rounding permits the test.
constexpr double kParallel = 1.0 - 5e-7;
constexpr double kLargestTilt = 1e-3;  // [rad], acos(kParallel)
// A plane fitted to some triangles extends to the triangles around them, which improve it: its
// range at least doubles, so 2^10 triangles a side are one surface.
constexpr int kMaxFits = 10;
constexpr double kNoChange = 0.01;  // of a plane, in tolerances
// The list of free facets is rebuilt when an eighth of it is taken.
constexpr std::size_t kCompaction = 8;

struct Facet3 {
  Triangle corners;
  Vec3d twice_area;  // along its normal
  Vec3d normal;      // unit
};

// A facet that may be without a group. Contiguous in memory, since every plane
// tests all of them.
struct FreeFacet {
  std::size_t number;
  Vec3d normal;
  double least_cosine;  // to the normal of a plane that contains all its corners, up to rounding
};

class PlaneFinder {
 public:
  explicit PlaneFinder(const Mesh& mesh) : tolerance_(coplanar_tolerance(mesh)) {
    for (const auto& [a, b, c] : mesh.triangles) {
      add({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
    }
    for (const Facet3& facet : facets_) {
      size_ = std::max(size_, 2.0 * norm(facet.corners[0] - facets_[0].corners[0]));
    }
    group_.assign(facets_.size(), kNoGroup);
    largest_first_.resize(facets_.size());
    std::iota(largest_first_.begin(), largest_first_.end(), std::size_t{0});
    std::stable_sort(
        largest_first_.begin(), largest_first_.end(), [&](std::size_t i, std::size_t j) {
          return norm(facets_[i].twice_area) > norm(facets_[j].twice_area);
        });
    free_.reserve(facets_.size());
    for (const std::size_t i : largest_first_) {
      free_.push_back({i, facets_[i].normal, least_cosine(facets_[i])});
    }
  }

  std::vector<MeshSurface> find(double rounding) {
    std::vector<Plane<double>> planes;
    for (const std::size_t seed : largest_first_) {
      if (group_[seed] == kNoGroup) {
        planes.push_back(take_plane(seed, planes.size()));
      }
    }
    return surfaces(planes, rounding);
  }

 private:
  // No group: a facet that belongs to no surface yet.
  static constexpr std::size_t kNoGroup = static_cast<std::size_t>(-1);

  void add(const Triangle& t) {
    const Vec3d twice_area = cross(t[1] - t[0], t[2] - t[0]);
    facets_.push_back({t, twice_area, unit_vector(twice_area)});
  }

  // Corners that are off by the tolerance tilt a low triangle by more than a tall one.
  double least_cosine(const Facet3& facet) const {
    const auto& [a, b, c] = facet.corners;
    const double height =
        norm(facet.twice_area) / std::max({norm(b - a), norm(c - a), norm(c - b)});
    const double tilt = std::max(kLargestTilt, 3.0 * tolerance_ / height);
    return tilt < 1.0 ? 1.0 - 0.5 * tilt * tilt : 0.0;
  }

  bool fits(const Plane<double>& plane, const FreeFacet& facet) const {
    const Triangle& corners = facets_[facet.number].corners;
    return std::abs(dot(plane.normal, facet.normal)) >= facet.least_cosine &&
           group_[facet.number] == kNoGroup &&
           std::all_of(corners.begin(), corners.end(), [&](const Vec3d& corner) {
             return std::abs(distance(plane, corner)) <= tolerance_;
           });
  }

  // The plane of the seed and of all facets in it, which are then no longer free.
  Plane<double> take_plane(std::size_t seed, std::size_t number) {
    const Facet3& first = facets_[seed];
    Plane<double> plane{first.normal, dot(first.normal, first.corners[0])};
    std::vector<std::size_t> members;
    for (int i = 0; i < kMaxFits; ++i) {
      std::vector<std::size_t> met;
      for (const FreeFacet& facet : free_) {
        if (facet.number == seed || fits(plane, facet)) {
          met.push_back(facet.number);
        }
      }
      if (met == members) {
        break;
      }
      members = std::move(met);
      if (members.size() == 1) {
        break;
      }
      const Plane<double> before = std::exchange(plane, fitted(members, first));
      // Where planes are exact, as most are, no further facets are in range.
      if (norm(plane.normal - before.normal) * size_ +
              std::abs(distance(plane, first.corners[0]) - distance(before, first.corners[0])) <=
          kNoChange * tolerance_) {
        break;
      }
    }
    for (const std::size_t k : members) {
      group_[k] = number;
    }
    taken_ += members.size();
    // Rarely, since moving the others would cost more than testing them.
    if (kCompaction * taken_ >= free_.size()) {
      std::erase_if(free_, [&](const FreeFacet& f) { return group_[f.number] != kNoGroup; });
      taken_ = 0;
    }
    return plane;
  }

  // Through the middle of the triangles, with the mean of their normals by area: that depends on
  // their common outline only, so rounding within it cancels.
  Plane<double> fitted(std::span<const std::size_t> members, const Facet3& first) const {
    Vec3d sum;
    Vec3d moment;  // from the first corner, to keep precision far from the origin
    double weight = 0.0;
    const Vec3d& origin = first.corners[0];
    for (const std::size_t k : members) {
      const Facet3& f = facets_[k];
      sum = sum + (dot(f.twice_area, first.normal) < 0.0 ? -f.twice_area : f.twice_area);
      const double area = norm(f.twice_area);
      for (const Vec3d& corner : f.corners) {
        moment = moment + area * (corner - origin);
      }
      weight += 3.0 * area;
    }
    const Vec3d normal = unit_vector(sum);
    return {normal, dot(normal, origin) + dot(normal, (1.0 / weight) * moment)};
  }

  std::vector<MeshSurface> surfaces(std::span<const Plane<double>> planes, double rounding) const {
    struct Members {
      std::vector<Triangle> triangles;
      bool one_facing = true;
    };
    std::vector<Members> groups(planes.size());
    // The largest triangle of each comes first: it determines the axes of the surface.
    for (const std::size_t i : largest_first_) {
      Members& members = groups[group_[i]];
      members.triangles.push_back(facets_[i].corners);
      // A sliver has no reliable normal.
      const double along = dot(planes[group_[i]].normal, facets_[i].normal);
      members.one_facing = members.one_facing && along > -kParallel;
    }
    std::vector<MeshSurface> found;
    found.reserve(planes.size());
    std::vector<bool> is_found(planes.size(), false);
    for (const std::size_t group : group_) {  // in the order of their first triangles
      if (!is_found[group]) {
        is_found[group] = true;
        found.push_back(
            {Surface(planes[group], groups[group].triangles, rounding), groups[group].one_facing});
      }
    }
    return found;
  }

  double tolerance_;
  double size_ = 0.0;  // largest distance between corners [m]
  std::vector<Facet3> facets_;
  std::vector<std::size_t> group_;  // of each facet
  std::vector<std::size_t> largest_first_;
  std::vector<FreeFacet> free_;  // the largest first
  std::size_t taken_ = 0;        // number of entries of free_ taken by groups
};

}  // namespace

std::vector<MeshSurface> planar_surfaces(const Mesh& mesh) {
  return PlaneFinder(mesh).find(mesh.rounding);
}

}  // namespace rayloc
