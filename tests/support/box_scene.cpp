#include "tests/support/box_scene.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "tests/support/scenes.h"

namespace rayloc::test {
namespace {

// Thickness of a face [m], typical of its material.
double thickness_of(const std::string& material) {
  if (material == "concrete") {
    return 0.2;
  }
  if (material == "metal") {
    return 0.002;
  }
  return material == "glass" ? 0.006 : 0.02;
}

template <typename Value>
Value value_or_abort(Expected<Value> value) {
  if (!value) {
    std::fprintf(stderr, "scene of boxes: %s\n", value.error().message.c_str());
    std::abort();
  }
  return std::move(*value);
}

}  // namespace

std::shared_ptr<const Scene> scene_of_boxes(const std::vector<SceneBox>& boxes) {
  Scene::Input input;
  input.carrier_hz = kCarrier;
  std::vector<std::string> names;
  for (const SceneBox& box : boxes) {
    auto material = std::find(names.begin(), names.end(), box.material);
    if (material == names.end()) {
      input.materials.push_back(
          value_or_abort(itu_material(box.material, kCarrier, thickness_of(box.material))));
      names.push_back(box.material);
      material = std::prev(names.end());
    }
    input.objects.push_back({box.name,
                             box_mesh(box.lower, box.upper),
                             static_cast<std::uint32_t>(material - names.begin())});
  }
  return std::make_shared<const Scene>(value_or_abort(Scene::create(std::move(input))));
}

bool is_free(const std::vector<SceneBox>& boxes, const Vec3d& point, double clearance) {
  return std::none_of(boxes.begin(), boxes.end(), [&](const SceneBox& box) {
    return point.x > box.lower.x - clearance && point.x < box.upper.x + clearance &&
           point.y > box.lower.y - clearance && point.y < box.upper.y + clearance &&
           point.z > box.lower.z - clearance && point.z < box.upper.z + clearance;
  });
}

}  // namespace rayloc::test
