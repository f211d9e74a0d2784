// draw_scene: a picture of a scene with its antennas and the paths between them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "daemon/site/plan/drawing.h"
#include "engine/base/vec3.h"
#include "engine/scene/scene.h"

namespace rayloc::draw {

// kPlan: cut through at breast height and seen from above. k3d: isometric, from the south-west,
// with the walls on the viewer's side and the ceiling left open.
enum class View : std::uint8_t { kPlan, k3d };

enum class MarkKind : std::uint8_t { kAccessPoint, kTransmitter, kReceiver };

struct Mark {
  std::string name;
  MarkKind kind = MarkKind::kAccessPoint;
  std::vector<Vec3d> antennas;  // at least one
  Vec3d heading;                // heading, a unit vector; for access points
};

struct DrawnPath {
  std::vector<Vec3d> points;  // from the transmitter to the receiver
  double power_db = 0.0;
};

inline constexpr Colour kZoneInk{130, 60, 130, 1.0};
inline constexpr Colour kZoneTint{130, 60, 130, 0.12};

// A zone on the floor.
struct DrawnZone {
  std::string name;
  std::vector<std::array<double, 2>> polygon;  // [m]
};

struct ScenePicture {
  const Scene* scene = nullptr;
  std::string title;
  std::string caption;  // below the title
  std::vector<Mark> marks;
  std::vector<DrawnPath> paths;
  std::vector<DrawnZone> zones;
  double strongest_db = 0.0;  // upper end of the colours
  double weakest_db = 0.0;
};

// REQUIRES: picture.scene != nullptr.
Drawing draw_scene(const ScenePicture& picture, View view);

}  // namespace rayloc::draw
