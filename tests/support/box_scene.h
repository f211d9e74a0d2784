// Rooms of axis-aligned boxes of ITU-R P.2040-3 materials, for benchmarks and tests that need more
// furniture than a handful.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/scene/scene.h"

namespace rayloc::test {

struct SceneBox {
  std::string name;
  std::string material;  // a name of the ITU table
  Vec3d lower;           // [m], world
  Vec3d upper;
};

// One object a box: 12 triangles, 6 surfaces, at kCarrier. Aborts the test program when the scene
// is refused.
std::shared_ptr<const Scene> scene_of_boxes(const std::vector<SceneBox>& boxes);

// Whether the point keeps `clearance` [m] from every box.
bool is_free(const std::vector<SceneBox>& boxes, const Vec3d& point, double clearance);

}  // namespace rayloc::test
