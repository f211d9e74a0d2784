// The bearing of a path as the phase psi from one antenna of a line to the next.
//
// Nothing here tells aliases apart: at more than half a wavelength between antennas several
// directions have one phase, and places are compared with phases on the circle.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/antenna_array.h"

namespace rayloc {

// Antennas of an array that stand on a line along its local y, equally far apart.
struct AntennaLine {
  std::vector<std::size_t> element;  // of the array, by local y
  double spacing = 0.0;              // [m]
};

// Of these elements; nothing of fewer than two, or where they do not stand so.
std::optional<AntennaLine> antenna_line(const AntennaArray& array,
                                        std::vector<std::size_t> elements);

// [rad], not wrapped, of a sender at `place`, by the true distances of the antennas: near the array
// the wave is not plane. In least squares over the line.
double psi_of(const AntennaArray& array,
              const AntennaLine& line,
              const Vec3d& place,
              double wavelength);

// The sines of the azimuths from boresight that have this phase, ascending.
std::vector<double> sines_of(double psi, double spacing, double wavelength);

}  // namespace rayloc
