// Ray: the properties of a traced path between a device and the centre of an antenna array that the
// observation model needs.
//
// The array is small against the length of a path, and all surfaces are planes, so the path to
// every element comes from the same mirror image of the device: its length is exact for each.
#pragma once

#include <complex>
#include <vector>

#include "engine/base/mat3.h"
#include "engine/base/vec3.h"
#include "engine/room/room_model.h"
#include "engine/trace/paths.h"

namespace rayloc {

struct Ray {
  std::complex<double> amplitude;  // without propagation phase
  double length = 0.0;             // [m], device to the array's centre
  Vec3d at_array;                  // unit, from the array towards the arriving wave
  Vec3d at_device;                 // unit, direction of departure from the device
  int reflections = 0;
  // Sum over the reflections of cos^2 of the angle of incidence: a surface displaced by s along its
  // normal changes the length by 2 s cos.
  double cos2_incidence = 0.0;
  // Maps vectors at the array to its mirror image, as seen from the device: at_device =
  // -(mirror * at_array).
  Mat3<float> mirror;
};

// Vector from the device to the image of an element that is `element_offset` [m] from the array's
// centre. The image is fixed when the device moves, as long as the ray meets the same surfaces:
// from a position displaced by `moved` the vector is image_of(...) - moved, and the derivative of
// its length is minus its direction (Fermat).
inline Vec3d image_of(const Ray& ray, const Vec3d& element_offset) {
  const Vec3<float> offset{static_cast<float>(element_offset.x),
                           static_cast<float>(element_offset.y),
                           static_cast<float>(element_offset.z)};
  const Vec3<float> rotated = ray.mirror * offset;
  return ray.length * ray.at_device + Vec3d{static_cast<double>(rotated.x),
                                            static_cast<double>(rotated.y),
                                            static_cast<double>(rotated.z)};
}

// Largest number of rays per position in a likelihood.
inline constexpr std::size_t kMaxRays = 64;

// The paths from `device` (transmitter) to the centre of the array (receiver), strongest first, at
// most `most`, each with the corrections of the surfaces that it meets.
std::vector<Ray> rays_of(const Paths& paths,
                         const RoomModel& room,
                         const Vec3d& device,
                         std::size_t most);

}  // namespace rayloc
