// Small scenes made in memory, for tests.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/scene/scene.h"

namespace rayloc::test {

inline constexpr double kCarrier = 5.18e9;  // [Hz]

// The twelve triangles of a box, normals outwards.
Mesh box_mesh(const Vec3d& lower, const Vec3d& upper);

// One rectangle corner, corner + u, corner + u + v, corner + v.
Mesh rectangle_mesh(const Vec3d& corner, const Vec3d& u, const Vec3d& v);

struct NamedMesh {
  std::string name;
  Mesh mesh;
};

// All objects have the same material. Aborts the test program when the scene is refused.
std::shared_ptr<const Scene> make_scene(const std::vector<NamedMesh>& meshes,
                                        const RadioMaterial& material,
                                        double carrier_hz = kCarrier);

inline const RadioMaterial kConcrete{"concrete", 5.24, 0.1672594689754, 0.1};

}  // namespace rayloc::test
