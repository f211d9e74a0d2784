#include "engine/trace/scattering/target_body.h"

#include <cmath>
#include <string>

#include "engine/base/constants.h"
#include "engine/em/radio_material.h"

namespace rayloc {

Expected<CylinderScatterer> make_scatterer(const TargetBody& body, double carrier_hz) {
  if (!(std::isfinite(body.conductivity) && body.conductivity >= 0.0)) {
    return bad_input("body: conductivity is " + std::to_string(body.conductivity) +
                     ", must be 0 or more [S/m]");
  }
  const RadioMaterial material{"body", body.relative_permittivity, body.conductivity};
  return CylinderScatterer::create({body.semi_axes,
                                    body.yaw,
                                    body.base,
                                    body.height,
                                    complex_permittivity(material, carrier_hz)},
                                   kSpeedOfLight / carrier_hz);
}

}  // namespace rayloc
