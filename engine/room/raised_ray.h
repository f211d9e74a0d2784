// A ray of a device that has risen above the place that was traced.
//
// The mirror image of the array stays where it is, so length and directions are exact as long as
// the ray meets the same surfaces. Its strength follows the length and both antennas' patterns;
// what the reflections do at other angles is left to the uncertainty of a ray's strength.
#pragma once

#include <span>
#include <vector>

#include "engine/room/ray.h"
#include "engine/room/room_model.h"

namespace rayloc {

// The rays to the centre of `array` from a device `by` [m] above where they begin.
std::vector<Ray> raised_rays(std::span<const Ray> rays,
                             double by,
                             const DeviceModel& device,
                             const AntennaArray& array);

}  // namespace rayloc
