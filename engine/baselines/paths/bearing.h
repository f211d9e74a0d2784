// The bearing of a path as the phase psi from one antenna of a line to the next.
//
// Aliases are not separated here: at more than half a wavelength between antennas several
// directions have one phase, and places are compared with phases on the circle.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/antenna_array.h"

namespace rayloc {

// Antennas of an array on a line along its local y, equally spaced.
struct AntennaLine {
  std::vector<std::size_t> element;  // indices in the array, by local y
  double spacing = 0.0;              // [m]
};

// The line of these elements; empty for fewer than two, or without such a line.
std::optional<AntennaLine> antenna_line(const AntennaArray& array,
                                        std::vector<std::size_t> elements);

// [rad], not wrapped, for a sender at `place`, from the true distances of the antennas: near the
// array the wave is not plane. Least squares over the line.
double psi_of(const AntennaArray& array,
              const AntennaLine& line,
              const Vec3d& place,
              double wavelength);

// The sines of the azimuths from boresight with this phase, ascending.
std::vector<double> sines_of(double psi, double spacing, double wavelength);

}  // namespace rayloc
