#include "engine/scene/scene_hash.h"

#include "engine/base/content_hash.h"
#include "engine/base/vec3.h"
#include "engine/scene/scene.h"

namespace rayloc {
// Excludes scattering properties of materials: no calibration and no ray depends on them.
std::string scene_hash(const Scene& scene) {
  ContentHash hash;
  for (const SceneObject& object : scene.objects()) {
    hash.add(object.name);
    for (const Vec3d& vertex : object.mesh.vertices) {
      hash.add(vertex);
    }
    for (const auto& triangle : object.mesh.triangles) {
      for (const auto index : triangle) {
        hash.add(static_cast<std::uint64_t>(index));
      }
    }
    const RadioMaterial& material = scene.materials()[object.material];
    hash.add(material.relative_permittivity);
    hash.add(material.conductivity);
    hash.add(material.thickness);
  }
  hash.add(scene.carrier_hz());
  return hash.text();
}

}  // namespace rayloc
