#include "daemon/site/plan/floor_plan.h"

#include <algorithm>
#include <cmath>

namespace rayloc::draw {
namespace {

constexpr double kCutHeight = 1.3;    // [m] above the lowest point, at most half the height
constexpr double kNearlyLevel = 0.2;  // |z| of the normal from which a face is seen from above

double highest(const Face& face) {
  double z = face.corners[0].z;
  for (const Vec3d& corner : face.corners) {
    z = std::max(z, corner.z);
  }
  return z;
}

std::vector<Face> faces_below(const Scene& scene, double cut) {
  std::vector<Face> faces = scene_faces(scene);
  std::erase_if(faces, [&](const Face& face) {
    const bool seen =
        face.solid ? face.normal.z > kNearlyLevel : std::abs(face.normal.z) > kNearlyLevel;
    return !seen || highest(face) > cut;
  });
  std::stable_sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
    return highest(a) < highest(b);
  });
  return faces;
}

}  // namespace

FloorPlan floor_plan(const Scene& scene, const std::vector<ScenePart>& parts) {
  const double height = scene.bounds_max().z - scene.bounds_min().z;
  const double cut = scene.bounds_min().z + std::min(kCutHeight, 0.5 * height);
  FloorPlan plan;
  plan.below = faces_below(scene, cut);
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    const Bounds& bounds = parts[i].bounds;
    if (bounds.lower.z < cut && bounds.upper.z >= cut) {
      plan.cuts.push_back({i, cut_mesh(scene.objects()[i].mesh, cut)});
    } else if (bounds.lower.z >= cut && parts[i].kind != PartKind::kCeiling) {
      plan.overhead.push_back(i);
    }
  }
  return plan;
}

}  // namespace rayloc::draw
