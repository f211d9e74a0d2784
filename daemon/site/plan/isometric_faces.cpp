#include "daemon/site/plan/isometric_faces.h"

#include <algorithm>
#include <utility>

#include "daemon/site/plan/painter_order.h"
#include "daemon/site/plan/palette.h"
#include "engine/scene/bounds.h"

namespace rayloc::draw {
namespace {

// True if the object would hide the room: the ceiling, and
// thin objects at the viewer's sides, at the smallest x and y.
bool is_left_open(const ScenePart& part, const Bounds& all) {
  constexpr double kThin = 0.3;     // [m]
  constexpr double kAtSide = 0.35;  // [m]
  const Vec3d size = part.bounds.size();
  return part.kind == PartKind::kCeiling ||
         (size.x < kThin && part.bounds.upper.x < all.lower.x + kAtSide) ||
         (size.y < kThin && part.bounds.upper.y < all.lower.y + kAtSide);
}

// Light from above the viewer's right shoulder.
double light_on(const Face& face, const Vec3d& towards_viewer) {
  const Vec3d lamp = normalized(Vec3d{-0.35, -0.6, 0.8});
  const bool away = dot(face.normal, towards_viewer) < 0.0;
  return 0.78 + 0.24 * std::max(0.0, dot(away ? -face.normal : face.normal, lamp));
}

}  // namespace

IsometricFaces isometric_faces(std::vector<Face> faces,
                               const std::vector<ScenePart>& parts,
                               const Vec3d& towards_viewer) {
  Bounds all;
  for (const ScenePart& part : parts) {
    all.include(part.bounds.lower);
    all.include(part.bounds.upper);
  }
  std::vector<Face> filled;
  IsometricFaces found;
  for (Face& face : faces) {
    const bool faces_away = face.solid && dot(face.normal, towards_viewer) < 1e-9;
    if (faces_away) {
      continue;
    }
    auto& to = is_left_open(parts[face.object], all) ? found.open : filled;
    to.push_back(std::move(face));
  }
  found.filled.reserve(filled.size());
  for (Face& face : painter_order(std::move(filled), towards_viewer)) {
    const Colour colour =
        shaded(material_colour(parts[face.object].material), light_on(face, towards_viewer));
    found.filled.push_back({std::move(face), colour});
  }
  return found;
}

}  // namespace rayloc::draw
