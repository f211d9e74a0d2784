// Scene: the objects of a place, as planar surfaces with radio materials at one carrier frequency.
//
// Immutable; build a new one to change a wall or a material.
// Thread safety: const members may be used from many threads.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/em/radio_material.h"
#include "engine/scene/bvh.h"
#include "engine/scene/mesh.h"
#include "engine/scene/scene_note.h"
#include "engine/scene/solid.h"
#include "engine/scene/surface.h"

namespace rayloc {

class RayShooter;
template <typename T>
class Lazy;

struct SceneObject {
  std::string name;
  Mesh mesh;
  std::uint32_t material = 0;  // index into the scene's materials
};

class Scene {
 public:
  // The object of a surface.
  struct SurfaceOwner {
    std::uint32_t object = 0;
    bool one_facing = false;  // MeshSurface::one_facing
  };
  struct Input {
    std::vector<SceneObject> objects;
    std::vector<RadioMaterial> materials;  // at the carrier
    double carrier_hz = 0.0;
    std::vector<SceneNote> notes{};  // from the reader of the objects
  };

  // An Error for an empty scene, an object without a triangle, a vertex that is not finite, an
  // index out of range, or an unphysical material; each names the object. Degenerate triangles
  // (less than a micrometre high; exporters produce them) are dropped and counted.
  static Expected<Scene> create(Input input);
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;

  const std::vector<SceneObject>& objects() const { return objects_; }
  const std::vector<RadioMaterial>& materials() const { return materials_; }
  double carrier_hz() const { return carrier_hz_; }
  // Notes for people on how the scene's file was read. Empty for a scene made from another one.
  const std::vector<SceneNote>& notes() const { return notes_; }

  // Surfaces of all objects; those of one object are adjacent.
  const std::vector<Surface>& surfaces() const { return surfaces_; }
  const SurfaceOwner& owner(std::uint32_t surface) const { return owners_[surface]; }
  const RadioMaterial& material_of(std::uint32_t surface) const {
    return materials_[objects_[owners_[surface].object].material];
  }
  struct SurfaceRange {
    std::uint32_t first, end;
  };
  SurfaceRange surfaces_of(std::uint32_t object) const {
    return {first_surface_[object], first_surface_[object + 1]};
  }
  const Solid& solid(std::uint32_t object) const { return solids_[object]; }

  bool is_blocked(const Segment& segment) const { return bvh_.is_blocked(segment); }
  void crossings(const Segment& segment, std::vector<Crossing>& found) const {
    bvh_.crossings(segment, found);
  }

  // For proposals (ray_shooter.h); made on first use.
  const RayShooter& shooter() const;

  Vec3d bounds_min() const { return bounds_min_; }  // [m], over all vertices
  Vec3d bounds_max() const { return bounds_max_; }
  std::size_t triangle_count() const { return triangle_count_; }
  std::size_t dropped_triangles() const { return dropped_triangles_; }

 private:
  Scene(Input input, std::vector<Surface> surfaces, std::vector<SurfaceOwner> owners, Bvh bvh);

  std::vector<SceneObject> objects_;
  std::vector<RadioMaterial> materials_;
  double carrier_hz_ = 0.0;
  std::vector<SceneNote> notes_;
  std::vector<Surface> surfaces_;  // on the heap, at a fixed address for the Bvh even after a move
  std::vector<SurfaceOwner> owners_;
  std::vector<std::uint32_t> first_surface_;  // start index of each object, and the end
  std::vector<Solid> solids_;
  Bvh bvh_;
  std::unique_ptr<const Lazy<RayShooter>> shooter_;
  Vec3d bounds_min_;
  Vec3d bounds_max_;
  std::size_t triangle_count_ = 0;
  std::size_t dropped_triangles_ = 0;
};

}  // namespace rayloc
