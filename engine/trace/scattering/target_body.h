// TargetBody: a person or another upright body without a device, modelled as an elliptic lossy
// cylinder at a movable position, which changes the channel of links.
#pragma once

#include <array>

#include "engine/base/expected.h"
#include "engine/em/cylinder_scatterer.h"

namespace rayloc {

struct TargetBody {
  std::array<double, 2> semi_axes{0.2, 0.2};  // [m]; equal: a circle of that radius
  double yaw = 0.0;                           // [rad], of the first semi-axis from +x
  double base = 0.0;                          // [m], z of the lower end
  double height = 1.75;                       // [m]
  double relative_permittivity = 36.0;        // skin at 5 GHz
  double conductivity = 4.0;                  // [S/m]
};

// Position of its axis, world [m].
struct TargetPosition {
  double x = 0.0;
  double y = 0.0;
};

// An Error that names the invalid value.
Expected<CylinderScatterer> make_scatterer(const TargetBody& body, double carrier_hz);

}  // namespace rayloc
