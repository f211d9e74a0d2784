// SceneFrame: the convention in which a scene may have been written: its unit, its up axis, its
// origin.
//
// The file of a scene states none of these. It must fit the box that a site states: find_frame()
// searches for the frame in which faces of the scene coincide with the sides of that box.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "engine/base/vec3.h"
#include "engine/scene/bounds.h"
#include "engine/scene/scene.h"

namespace rayloc {

// "4 x 3 x 2.5 m"
std::string size_text(const Vec3d& size);

// A point p of the scene is at scale * (the permuted axes of p) + shift in the room.
struct SceneFrame {
  struct Axis {
    std::size_t of_scene = 0;  // 0 x, 1 y, 2 z
    double sign = 1.0;
  };
  double scale = 1.0;
  std::array<Axis, 3> axes = {{{0, 1.0}, {1, 1.0}, {2, 1.0}}};  // of the room's x, y, z
  Vec3d shift;                                                  // [m]

  bool is_scaled() const { return scale != 1.0; }
  bool is_rotated() const;
  bool is_shifted() const { return shift != Vec3d{}; }
  Vec3d to_room(const Vec3d& p) const;
  Vec3d to_scene(const Vec3d& p) const;
};

// Number of the six sides of `room` that are on faces of the scene: for more than half of the side,
// a face is within half a metre, or within an eighth of the room if that is less.
int covered_sides(const Scene& scene, const SceneFrame& frame, const Bounds& room);

// The simplest frame other than the scene's own in which five sides of `room` or all are on faces;
// empty if there is none, or if the scene's own frame is nearly as good. Units are those of
// kMistakenUnits and their inverses. The scene is as large as the room, or larger if neither its
// origin is shifted nor its plan is rotated.
std::optional<SceneFrame> find_frame(const Scene& scene, const Bounds& room);

}  // namespace rayloc
