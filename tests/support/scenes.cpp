#include "tests/support/scenes.h"

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace rayloc::test {

Mesh box_mesh(const Vec3d& lower, const Vec3d& upper) {
  Mesh mesh;
  for (unsigned i = 0; i < 8; ++i) {
    mesh.vertices.push_back({(i & 1U) != 0 ? upper.x : lower.x,
                             (i & 2U) != 0 ? upper.y : lower.y,
                             (i & 4U) != 0 ? upper.z : lower.z});
  }
  mesh.triangles = {{0, 2, 3},
                    {0, 3, 1},
                    {4, 5, 7},
                    {4, 7, 6},
                    {0, 1, 5},
                    {0, 5, 4},
                    {2, 6, 7},
                    {2, 7, 3},
                    {0, 4, 6},
                    {0, 6, 2},
                    {1, 3, 7},
                    {1, 7, 5}};
  return mesh;
}

Mesh rectangle_mesh(const Vec3d& corner, const Vec3d& u, const Vec3d& v) {
  return {{corner, corner + u, corner + u + v, corner + v}, {{0, 1, 2}, {0, 2, 3}}};
}

std::shared_ptr<const Scene> make_scene(const std::vector<NamedMesh>& meshes,
                                        const RadioMaterial& material,
                                        double carrier_hz) {
  Scene::Input input;
  input.carrier_hz = carrier_hz;
  input.materials = {material};
  for (const NamedMesh& named : meshes) {
    input.objects.push_back({named.name, named.mesh, 0});
  }
  auto scene = Scene::create(std::move(input));
  if (!scene) {
    std::fprintf(stderr, "test scene: %s\n", scene.error().message.c_str());
    std::abort();
  }
  return std::make_shared<const Scene>(std::move(*scene));
}

}  // namespace rayloc::test
