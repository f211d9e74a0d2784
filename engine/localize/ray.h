// Ray: what the observation model needs of a traced path between a device and the centre of an
// antenna array.
//
// The array is small against the length of a path, and all surfaces are planes, so the path to
// every element is that of the same mirror image of the device: its length is exact for each.
#pragma once

#include <complex>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/localize/room_model.h"
#include "engine/trace/paths.h"

namespace rayloc {

struct Ray {
  std::complex<double> amplitude;  // without propagation phase
  double length = 0.0;             // [m], device to the array's centre
  Vec3d at_array;                  // unit, from the array to where the wave comes from
  Vec3d at_device;                 // unit, the way that the wave leaves the device
  int reflections = 0;
  // Sum over the reflections of cos^2 of the angle of incidence: a surface displaced by s along its
  // normal changes the length by 2 s cos.
  double cos2_incidence = 0.0;
};

// The paths from `device` (transmitter) to the centre of the array (receiver), strongest first, at
// most `most`, each with the corrections of the surfaces that it meets.
std::vector<Ray> rays_of(const Paths& paths,
                         const RoomModel& room,
                         const Vec3d& device,
                         std::size_t most);

}  // namespace rayloc
