// Rooms of axis-aligned boxes of ITU-R P.2040-3 materials, for benchmarks and tests that need more
// than a few pieces of furniture.
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

// Each box is an object: 12 triangles, 6 surfaces, at kCarrier. Aborts the test program when the
// scene is refused.
std::shared_ptr<const Scene> scene_of_boxes(const std::vector<SceneBox>& boxes);

// True if the point is at least `clearance` [m] away from every box.
bool is_free(const std::vector<SceneBox>& boxes, const Vec3d& point, double clearance);

}  // namespace rayloc::test
