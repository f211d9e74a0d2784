// planar_surfaces (surface.h): which triangles of a mesh are one mirror.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <span>
#include <utility>

#include "engine/scene/surface.h"

namespace rayloc {
namespace {

using Triangle = std::array<Vec3d, 3>;

// Normals of coplanar triangles: cos(angle) at least this, where rounding allows to tell.
constexpr double kParallel = 1.0 - 5e-7;
constexpr double kLargestTilt = 1e-3;  // [rad], acos(kParallel)
// A plane found from some triangles reaches those around them, which make it better: the reach
// doubles at least, so 2^10 triangles a side are one surface.
constexpr int kMostFits = 10;

Vec3d unit(const Vec3d& v) {
  const double length = norm(v);
  return {v.x / length, v.y / length, v.z / length};  // exact for a vector along an axis
}

struct Facet3 {
  Triangle corners;
  Vec3d twice_area;     // along its normal
  Vec3d normal;         // unit
  double least_cosine;  // to the normal of a plane that all its corners are in, up to rounding
};

class PlaneFinder {
 public:
  explicit PlaneFinder(const Mesh& mesh) : tolerance_(coplanar_tolerance(mesh)) {
    for (const auto& [a, b, c] : mesh.triangles) {
      add({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
    }
    group_.assign(facets_.size(), kNone);
    largest_first_.resize(facets_.size());
    std::iota(largest_first_.begin(), largest_first_.end(), std::size_t{0});
    std::stable_sort(
        largest_first_.begin(), largest_first_.end(), [&](std::size_t i, std::size_t j) {
          return norm(facets_[i].twice_area) > norm(facets_[j].twice_area);
        });
    free_ = largest_first_;
  }

  std::vector<MeshSurface> find(double rounding) {
    std::vector<Plane<double>> planes;
    while (!free_.empty()) {
      planes.push_back(take_plane(free_.front(), planes.size()));
    }
    return surfaces(planes, rounding);
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  void add(const Triangle& t) {
    const Vec3d twice_area = cross(t[1] - t[0], t[2] - t[0]);
    const double longest = std::max({norm(t[1] - t[0]), norm(t[2] - t[0]), norm(t[2] - t[1])});
    const double height = norm(twice_area) / longest;
    // Corners that are off by the tolerance tilt a low triangle by more than a tall one.
    const double tilt = std::max(kLargestTilt, 3.0 * tolerance_ / height);
    facets_.push_back(
        {t, twice_area, unit(twice_area), tilt < 1.0 ? 1.0 - 0.5 * tilt * tilt : 0.0});
  }

  bool fits(const Plane<double>& plane, const Facet3& facet) const {
    return std::abs(dot(plane.normal, facet.normal)) >= facet.least_cosine &&
           std::all_of(facet.corners.begin(), facet.corners.end(), [&](const Vec3d& corner) {
             return std::abs(distance(plane, corner)) <= tolerance_;
           });
  }

  // The plane of the seed and of all that are in it; they are no longer free.
  Plane<double> take_plane(std::size_t seed, std::size_t number) {
    const Facet3& first = facets_[seed];
    Plane<double> plane{first.normal, dot(first.normal, first.corners[0])};
    std::vector<std::size_t> members;
    for (int i = 0; i < kMostFits; ++i) {
      std::vector<std::size_t> met;
      std::copy_if(free_.begin(), free_.end(), std::back_inserter(met), [&](std::size_t k) {
        return k == seed || fits(plane, facets_[k]);
      });
      if (met == members) {
        break;
      }
      members = std::move(met);
      if (members.size() > 1) {
        plane = fitted(members, first);
      }
    }
    for (const std::size_t k : members) {
      group_[k] = number;
    }
    free_.erase(std::remove_if(
                    free_.begin(), free_.end(), [&](std::size_t k) { return group_[k] != kNone; }),
                free_.end());
    return plane;
  }

  // Through the middle of the triangles, with the mean of their normals by area: that is a matter
  // of their common outline, so rounding within it cancels.
  Plane<double> fitted(std::span<const std::size_t> members, const Facet3& first) const {
    Vec3d sum;
    Vec3d moment;  // from the first corner, so that nothing is lost far from the origin
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
    const Vec3d normal = unit(sum);
    return {normal, dot(normal, origin) + dot(normal, (1.0 / weight) * moment)};
  }

  std::vector<MeshSurface> surfaces(std::span<const Plane<double>> planes, double rounding) const {
    struct Members {
      std::vector<Triangle> triangles;
      bool one_facing = true;
    };
    std::vector<Members> groups(planes.size());
    // The largest triangle of each comes first: it gives the axes of the surface.
    for (const std::size_t i : largest_first_) {
      Members& members = groups[group_[i]];
      members.triangles.push_back(facets_[i].corners);
      // A sliver faces anywhere.
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
  std::vector<Facet3> facets_;
  std::vector<std::size_t> group_;  // of each facet
  std::vector<std::size_t> largest_first_;
  std::vector<std::size_t> free_;  // those without a group, the largest first
};

}  // namespace

std::vector<MeshSurface> planar_surfaces(const Mesh& mesh) {
  return PlaneFinder(mesh).find(mesh.rounding);
}

}  // namespace rayloc
