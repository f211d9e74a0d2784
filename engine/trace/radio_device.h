// Transmitter and Receiver: one antenna with its position and orientation.
//
// Two types, so that the ends of a link cannot be mixed up.
#pragma once

#include <vector>

#include "engine/base/vec3.h"
#include "engine/em/antenna_pattern.h"
#include "engine/scene/antenna_array.h"
#include "engine/trace/field_calculator.h"

namespace rayloc {

struct RadioDevice {
  Vec3d position;           // [m], world
  Orientation orientation;  // world from device
  AntennaPattern pattern = AntennaPattern::kIsotropic;
  Polarization polarization = Polarization::kVertical;
  Vec3d lever = {};  // [m], device frame: from the origin of the array that it belongs to
};

inline LinkEnd<double> link_end(const RadioDevice& device) {
  return {device.position, device.pattern, device.polarization, rotation(device.orientation)};
}

struct Transmitter : RadioDevice {};
struct Receiver : RadioDevice {};

// The elements of an array, each as a separate device (no plane-wave approximation).
template <typename Device>
std::vector<Device> array_elements(const AntennaArray& array) {
  std::vector<Device> elements;
  elements.reserve(array.element_offset.size());
  for (std::size_t i = 0; i < array.element_offset.size(); ++i) {
    elements.push_back(Device{{element_position(array, i),
                               array.pose.orientation,
                               array.pattern,
                               array.polarization,
                               array.element_offset[i]}});
  }
  return elements;
}

// One device at the array's origin, in place of all of its elements.
template <typename Device>
Device array_origin(const AntennaArray& array) {
  return Device{{array.pose.position, array.pose.orientation, array.pattern, array.polarization}};
}

}  // namespace rayloc
