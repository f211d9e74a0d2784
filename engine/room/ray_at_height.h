// Ray of a device that is above the position that was traced.
//
// The mirror image of the array is fixed, so length and directions are exact as long as the ray
// meets the same surfaces. The amplitude follows the length and both antennas' patterns; the change
// of the reflections with the angle is left to the uncertainty of a ray's strength.
#pragma once

#include <span>
#include <vector>

#include "engine/room/ray.h"
#include "engine/room/room_model.h"

namespace rayloc {

// The rays to the centre of `array` from a device `by` [m] above their traced starting point.
std::vector<Ray> rays_at_height(std::span<const Ray> rays,
                                double by,
                                const DeviceModel& device,
                                const AntennaArray& array);

}  // namespace rayloc
