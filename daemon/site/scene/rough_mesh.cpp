#include "daemon/site/scene/rough_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <tuple>
#include <unordered_set>
#include <utility>
#include <vector>

#include "engine/scene/bounds.h"
#include "engine/scene/unit_vector.h"

namespace rayloc {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;  // [rad]
constexpr double kWallSize = 2.0;                     // [m], chosen: for the two larger extents
constexpr std::size_t kFewestTriangles = 200;         // count, chosen: fewer are drawn by hand
constexpr double kMinBend = 0.06 * kDegree;           // for faces that are not coplanar (surface.h)
// A noise of 1 cm bends triangles of 10 cm by 15 degrees; corners of furniture are right angles.
constexpr double kMaxBend = 50.0 * kDegree;
constexpr double kMinBentShare = 0.6;  // ratio, chosen: a scan has 0.9 and more
constexpr double kPatchRadius =
    0.6;  // [m], chosen: a third of the patches of a small room have no corner
constexpr double kPatchEdges = 3.0;    // minimum triangle edges per patch radius, chosen
constexpr double kMaxNoise = 0.04;     // [m], rms, chosen: twice that of a phone's scan
constexpr double kMaxGrowth = 1.5;     // ratio, chosen: 1 for noise, 2 for a bent surface
constexpr double kFlatShare = 0.2;     // of the patches, chosen: the others contain corners
constexpr std::size_t kPatches = 300;  // count, chosen

constexpr std::uint32_t kNoTriangle = 0xffffffff;

double angle_between(const Vec3d& a, const Vec3d& b) {
  // Triangles of a scan may have either orientation.
  return std::atan2(norm(cross(a, b)), std::abs(dot(a, b)));
}

// The quantile at `share` of the values.
double quantile(std::vector<double> values, double share) {
  if (values.empty()) {
    return 0.0;
  }
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

struct Patch {
  double error = 0.0;  // [m], rms distance from its plane
  double near = 0.0;   // [rad], mean angle to the triangles at half of its radius
  double far = 0.0;    // [rad], to those at its radius
};

class Neighbours {
 public:
  explicit Neighbours(const Mesh& mesh) {
    const std::vector<std::uint32_t> place = places_of(mesh);
    std::vector<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> sides;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto& t = mesh.triangles[i];
      const Vec3d& p = mesh.vertices[t[0]];
      const Vec3d& q = mesh.vertices[t[1]];
      const Vec3d& r = mesh.vertices[t[2]];
      faces_.push_back({(1.0 / 3.0) * (p + q + r), cross(q - p, r - p)});
      side_ += (norm(q - p) + norm(r - q) + norm(p - r)) /
               (3.0 * static_cast<double>(mesh.triangles.size()));
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = place[t.at(k)];
        const std::uint32_t b = place[t.at((k + 1) % 3)];
        sides.emplace_back(std::min(a, b), std::max(a, b), i);
      }
    }
    std::sort(sides.begin(), sides.end());
    for (std::size_t k = 1; k < sides.size(); ++k) {
      const auto& [a, b, first] = sides[k - 1];
      const auto& [c, d, second] = sides[k];
      if (a == c && b == d) {
        join(first, second);
      }
    }
  }

  const std::vector<double>& angles() const { return angles_; }  // [rad], by pair

  // [m], the mean of all sides.
  double side() const { return side_; }

  // Patch around a triangle, as far as connected neighbours extend.
  std::optional<Patch> patch_around(std::uint32_t seed, double radius) const {
    std::unordered_set<std::uint32_t> met{seed};
    std::vector<std::uint32_t> members{seed};
    Vec3d area_vector;
    Vec3d moment;
    double area = 0.0;
    for (std::size_t i = 0; i < members.size(); ++i) {
      const Face& face = faces_[members[i]];
      // Triangles of a scan may have either orientation.
      const double along = dot(face.area_vector, faces_[seed].area_vector);
      area_vector = area_vector + (along < 0.0 ? -face.area_vector : face.area_vector);
      moment = moment + norm(face.area_vector) * face.middle;
      area += norm(face.area_vector);
      for (const std::uint32_t other : face.beside) {
        if (other != kNoTriangle && norm(faces_[other].middle - faces_[seed].middle) <= radius &&
            met.insert(other).second) {
          members.push_back(other);
        }
      }
    }
    return patch_of(members, unit_vector(area_vector), (1.0 / area) * moment, radius);
  }

 private:
  struct Face {
    Vec3d middle;
    Vec3d area_vector;  // along its normal, length: twice its area
    std::array<std::uint32_t, 3> beside{kNoTriangle, kNoTriangle, kNoTriangle};
  };

  std::optional<Patch> patch_of(std::span<const std::uint32_t> members,
                                const Vec3d& normal,
                                const Vec3d& middle,
                                double radius) const {
    // Rings of a fifth of their radius: [0.4, 0.5] and [0.8, 1] of the patch's.
    constexpr double kRing = 0.8;
    const Face& seed = faces_[members.front()];
    double squares = 0.0;
    std::array<double, 2> sums{};
    std::array<int, 2> counts{};
    for (const std::uint32_t member : members) {
      const Face& face = faces_[member];
      const double off = dot(normal, face.middle - middle);
      squares += off * off;
      for (std::size_t ring = 0; ring < sums.size(); ++ring) {
        const double outer = ring == 0 ? 0.5 * radius : radius;
        const double apart = norm(face.middle - seed.middle);
        if (apart <= outer && apart >= kRing * outer) {
          sums.at(ring) += angle_between(face.area_vector, seed.area_vector);
          ++counts.at(ring);
        }
      }
    }
    if (counts[0] == 0 || counts[1] == 0) {
      return std::nullopt;
    }
    return Patch{std::sqrt(squares / static_cast<double>(members.size())),
                 sums[0] / counts[0],
                 sums[1] / counts[1]};
  }
  // Vertices at the same place are one, regardless of duplicates for shading.
  static std::vector<std::uint32_t> places_of(const Mesh& mesh) {
    std::map<std::tuple<double, double, double>, std::uint32_t> numbers;
    std::vector<std::uint32_t> places;
    for (const Vec3d& v : mesh.vertices) {
      const auto next = static_cast<std::uint32_t>(numbers.size());
      places.push_back(numbers.try_emplace({v.x, v.y, v.z}, next).first->second);
    }
    return places;
  }

  void join(std::uint32_t first, std::uint32_t second) {
    const auto add = [&](std::uint32_t to, std::uint32_t other) {
      auto& beside = faces_[to].beside;
      const auto free = std::find(beside.begin(), beside.end(), kNoTriangle);
      if (free != beside.end()) {
        *free = other;
      }
    };
    add(first, second);
    add(second, first);
    angles_.push_back(angle_between(faces_[first].area_vector, faces_[second].area_vector));
  }

  std::vector<Face> faces_;
  std::vector<double> angles_;
  double side_ = 0.0;
};

bool is_as_large_as_a_wall(const Mesh& mesh) {
  const Vec3d size = bounds_of(mesh).size();
  std::array<double, 3> extents{size.x, size.y, size.z};
  std::sort(extents.begin(), extents.end());
  return extents[1] >= kWallSize;
}

bool has_bent_sides(const std::vector<double>& angles) {
  std::vector<double> bends;
  std::copy_if(angles.begin(), angles.end(), std::back_inserter(bends), [](double angle) {
    return angle > kMinBend;
  });
  return !bends.empty() &&
         static_cast<double>(bends.size()) >= kMinBentShare * static_cast<double>(angles.size()) &&
         quantile(bends, 0.5) <= kMaxBend;
}

}  // namespace

bool is_rough_mesh(const Mesh& mesh) {
  if (mesh.triangles.size() < kFewestTriangles || !is_as_large_as_a_wall(mesh)) {
    return false;
  }
  const Neighbours neighbours(mesh);
  if (!has_bent_sides(neighbours.angles())) {
    return false;
  }
  const double radius = std::max(kPatchRadius, kPatchEdges * neighbours.side());
  std::vector<Patch> patches;
  std::vector<double> errors;
  const std::size_t stride = std::max<std::size_t>(1, mesh.triangles.size() / kPatches);
  for (std::size_t i = 0; i < mesh.triangles.size(); i += stride) {
    if (const auto patch = neighbours.patch_around(static_cast<std::uint32_t>(i), radius)) {
      patches.push_back(*patch);
      errors.push_back(patch->error);
    }
  }
  if (patches.empty()) {
    return false;
  }
  const double flat = quantile(errors, kFlatShare);
  double near = 0.0;
  double far = 0.0;
  for (const Patch& patch : patches) {
    near += patch.error <= flat ? patch.near : 0.0;
    far += patch.error <= flat ? patch.far : 0.0;
  }
  return flat <= kMaxNoise && far <= kMaxGrowth * near;
}

}  // namespace rayloc
