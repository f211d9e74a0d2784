// AntennaArray: elements with one pattern on a rigid body.
//
// Orientation is yaw, pitch, roll about z, y, x (R = Rz Ry Rx); boresight is local +x.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/mat3.h"
#include "engine/base/vec3.h"
#include "engine/em/antenna_pattern.h"

namespace rayloc {

struct Orientation {
  double yaw = 0.0;    // [rad]
  double pitch = 0.0;  // [rad]
  double roll = 0.0;   // [rad]
};

inline Mat3d rotation(const Orientation& o) {
  return rotation_from_yaw_pitch_roll(o.yaw, o.pitch, o.roll);
}

struct Pose {
  Vec3d position;  // [m], world
  Orientation orientation;
};

struct AntennaArray {
  Pose pose;                          // world from array
  std::vector<Vec3d> element_offset;  // [m], array frame
  AntennaPattern pattern = AntennaPattern::kIsotropic;
  Polarization polarization = Polarization::kVertical;
};

// Position of element `i`, world coordinates.
inline Vec3d element_position(const AntennaArray& array, std::size_t i) {
  return array.pose.position + rotation(array.pose.orientation) * array.element_offset[i];
}

// Offsets of all elements from the array's position, world axes [m].
inline std::vector<Vec3d> offsets_of(const AntennaArray& array) {
  std::vector<Vec3d> offsets;
  offsets.reserve(array.element_offset.size());
  for (std::size_t i = 0; i < array.element_offset.size(); ++i) {
    offsets.push_back(element_position(array, i) - array.pose.position);
  }
  return offsets;
}

}  // namespace rayloc
