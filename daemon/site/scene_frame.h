// SceneFrame: a way in which a scene could have been written down: in which unit, with which axis
// up, from which origin.
//
// A file of a scene says neither. What it must fit is the box that a site states: find_frame()
// looks for the way in which the faces of the scene lie on the sides of that box.
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

// A point p of the scene is at scale * (one axis after another of p) + shift in the room.
struct SceneFrame {
  struct Axis {
    std::size_t of_scene = 0;  // 0 x, 1 y, 2 z
    double sign = 1.0;
  };
  double scale = 1.0;
  std::array<Axis, 3> axes = {{{0, 1.0}, {1, 1.0}, {2, 1.0}}};  // of the room's x, y, z
  Vec3d shift;                                                  // [m]

  bool is_scaled() const { return scale != 1.0; }
  bool is_turned() const;
  bool is_shifted() const { return shift != Vec3d{}; }
  Vec3d to_room(const Vec3d& p) const;
  Vec3d to_scene(const Vec3d& p) const;
};

// How many of the six sides of `room` lie on faces of the scene: more than half of a side has one
// no further away than half a metre, or an eighth of the room where that is less.
int covered_sides(const Scene& scene, const SceneFrame& frame, const Bounds& room);

// The simplest frame other than the scene's own in which five sides of `room` or all lie on faces;
// nothing when there is none, or the scene as it is does nearly as well. Units are those of
// kMistakenUnits and their inverses. The scene is as large as the room, or, where neither its
// origin is elsewhere nor its plan is turned, larger.
std::optional<SceneFrame> find_frame(const Scene& scene, const Bounds& room);

}  // namespace rayloc
