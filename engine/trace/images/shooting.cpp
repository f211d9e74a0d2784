#include "engine/trace/images/shooting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <span>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/scene/ray_shooter.h"
#include "engine/trace/images/fibonacci_lattice.h"

namespace rayloc {
namespace {

// Portions of the lattice, each with its own trie: few, since the tries overlap and are merged.
constexpr std::size_t kPortions = 16;

// True if the root is inside the material of a closed object.
bool is_within_object(const Scene& scene, std::uint32_t object, const Vec3d& root) {
  return scene.solid(object).shells > 0 && is_inside(scene.objects()[object].mesh, root);
}

bool is_coplanar(const Surface& face, const Surface& other) {
  constexpr double kMinCosine = 1.0 - 1e-6;  // between the normals, chosen: 1.4 mrad of tilt
  return std::abs(dot(face.plane().normal, other.plane().normal)) > kMinCosine &&
         std::all_of(other.outline().begin(), other.outline().end(), [&](const Vec3d& corner) {
           return std::abs(distance(face.plane(), corner)) <= kCoplanarTolerance;
         });
}

// For each surface, the surface that it counts as for rays that leave the root and only reflect.
// Where objects touch, a ray within one meets two coincident faces, and Embree returns either,
// depending on the instruction set: the face of the object that contains the ray is used.
std::vector<std::uint32_t> met_faces(const Scene& scene, const Vec3d& root) {
  std::vector<std::uint32_t> met(scene.surfaces().size());
  std::iota(met.begin(), met.end(), 0U);
  for (std::uint32_t object = 0; object < scene.objects().size(); ++object) {
    if (!is_within_object(scene, object, root)) {
      continue;
    }
    const auto [first, end] = scene.surfaces_of(object);
    for (std::uint32_t face = first; face < end; ++face) {
      // Within two objects at once, each face of a pair would replace the other.
      for (std::uint32_t other = 0; met[face] == face && other < met.size(); ++other) {
        if (met[other] == other && scene.owner(other).object != object &&
            is_coplanar(scene.surfaces()[face], scene.surfaces()[other])) {
          met[other] = face;
        }
      }
    }
  }
  return met;
}

// Rays with the sequences that they have met so far.
struct Flight {
  RayStream rays;
  RayStream::Lanes<std::uint32_t> node;  // of the trie
};

// Follows the rays of one portion. It has a stream for each number of interactions: 10 kB each.
class Follower {
 public:
  // REQUIRES: options.max_depth > 0.
  Follower(const RayShooter& shooter,
           std::span<const std::uint32_t> met_faces,
           const TraceOptions& options)
      : shooter_(shooter), met_faces_(met_faces), options_(options) {
    for (int i = 0; i < options.max_depth; ++i) {
      flights_.push_back(std::make_unique<Flight>());
    }
  }

  // Collects rays until a stream is full; finish() sends the rest.
  void add(const Vec3d& from, const Vec3d& direction) {
    Flight& flight = *flights_[0];
    const std::size_t i = flight.rays.size++;
    flight.rays.origin_x[i] = static_cast<float>(from.x);
    flight.rays.origin_y[i] = static_cast<float>(from.y);
    flight.rays.origin_z[i] = static_cast<float>(from.z);
    flight.rays.direction_x[i] = static_cast<float>(direction.x);
    flight.rays.direction_y[i] = static_cast<float>(direction.y);
    flight.rays.direction_z[i] = static_cast<float>(direction.z);
    flight.node[i] = MirrorTrie::kRoot;
    if (flight.rays.size == RayStream::kCapacity) {
      finish();
    }
  }

  void finish() {
    follow(0, false);
    flights_[0]->rays.size = 0;
  }

  MirrorTrie trie;
  std::size_t segments = 0;

 private:
  // Follows the rays of flights_[interactions], some of which may have passed through faces.
  void follow(std::size_t interactions, bool passed) {
    Flight& flight = *flights_[interactions];
    if (flight.rays.size == 0) {
      return;
    }
    segments += flight.rays.size;
    shooter_.shoot(flight.rays, interactions == 0 ? 0.0F : shooter_.clearance());
    const bool last = interactions + 1 == flights_.size();
    if (last) {
      reflect<true>(flight, passed, flight);
      return;
    }
    Flight& next = *flights_[interactions + 1];
    if (options_.transmission) {
      pass(flight, next);
      follow(interactions + 1, true);
    }
    reflect<false>(flight, passed, next);
    follow(interactions + 1, passed);
  }

  // Records the mirrors that the rays meet; the rays continue into `next` unless this is the last.
  template <bool kLast>
  void reflect(const Flight& flight, bool passed, Flight& next);
  // The rays continue straight.
  void pass(const Flight& flight, Flight& next) const;

  const RayShooter& shooter_;
  std::span<const std::uint32_t> met_faces_;
  TraceOptions options_;
  std::vector<std::unique_ptr<Flight>> flights_;
};

template <bool kLast>
void Follower::reflect(const Flight& flight, bool passed, Flight& next) {
  const RayStream& in = flight.rays;
  RayStream& out = next.rays;
  const auto triangles = shooter_.triangles();
  std::size_t kept = 0;
  // Neighbours mostly meet the same surfaces.
  std::uint32_t node = MirrorTrie::kRoot;
  std::uint32_t surface = kNoSurface;
  std::uint32_t child = MirrorTrie::kRoot;
  for (std::size_t i = 0; i < in.size; ++i) {
    if (in.triangle[i] == RayShooter::kNoTriangle) {
      continue;
    }
    const RayShooter::Triangle& met = triangles[in.triangle[i]];
    const std::uint32_t face = passed ? met.surface : met_faces_[met.surface];
    if (face != surface || flight.node[i] != node) {
      surface = face;
      node = flight.node[i];
      child = trie.extended(node, surface);
    }
    if constexpr (!kLast) {
      const float twice_along =
          2.0F * (met.normal_x * in.direction_x[i] + met.normal_y * in.direction_y[i] +
                  met.normal_z * in.direction_z[i]);
      out.origin_x[kept] = in.origin_x[i] + in.distance[i] * in.direction_x[i];
      out.origin_y[kept] = in.origin_y[i] + in.distance[i] * in.direction_y[i];
      out.origin_z[kept] = in.origin_z[i] + in.distance[i] * in.direction_z[i];
      out.direction_x[kept] = in.direction_x[i] - twice_along * met.normal_x;
      out.direction_y[kept] = in.direction_y[i] - twice_along * met.normal_y;
      out.direction_z[kept] = in.direction_z[i] - twice_along * met.normal_z;
      next.node[kept] = child;
      ++kept;
    }
  }
  if constexpr (!kLast) {
    out.size = kept;
  }
}

void Follower::pass(const Flight& flight, Flight& next) const {
  const RayStream& in = flight.rays;
  RayStream& out = next.rays;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < in.size; ++i) {
    if (in.triangle[i] == RayShooter::kNoTriangle) {
      continue;
    }
    out.origin_x[kept] = in.origin_x[i] + in.distance[i] * in.direction_x[i];
    out.origin_y[kept] = in.origin_y[i] + in.distance[i] * in.direction_y[i];
    out.origin_z[kept] = in.origin_z[i] + in.distance[i] * in.direction_z[i];
    out.direction_x[kept] = in.direction_x[i];
    out.direction_y[kept] = in.direction_y[i];
    out.direction_z[kept] = in.direction_z[i];
    next.node[kept] = flight.node[i];
    ++kept;
  }
  out.size = kept;
}

}  // namespace

ShotMirrors shoot_mirrors(const Scene& scene, const Vec3d& root, const TraceOptions& options) {
  ShotMirrors shot;
  if (options.max_depth > 0) {
    const RayShooter& shooter = scene.shooter();
    const Vec3d from = root - shooter.origin();
    const FibonacciLattice lattice(options.rays);
    const std::vector<std::uint32_t> faces = met_faces(scene, root);
    struct Portion {
      MirrorTrie trie;
      std::size_t segments = 0;
    };
    std::vector<Portion> portions(std::min(kPortions, lattice.rings()));
    parallel_for(portions.size(), 1, [&](std::size_t i) {
      Follower follower(shooter, faces, options);
      std::vector<Vec3d> directions;
      const std::size_t end = (i + 1) * lattice.rings() / portions.size();
      for (std::size_t ring = i * lattice.rings() / portions.size(); ring < end; ++ring) {
        lattice.directions(ring, directions);
        for (const Vec3d& direction : directions) {
          follower.add(from, direction);
        }
      }
      follower.finish();
      portions[i] = {std::move(follower.trie), follower.segments};
    });
    for (const Portion& portion : portions) {
      shot.trie.merge(portion.trie);
      shot.segments += portion.segments;
    }
  }
  shot.trie.put_in_order();
  return shot;
}

}  // namespace rayloc
