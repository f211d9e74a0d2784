// parse_parameters: the parameters of a scene and of the two ends of a link, selected by name.
//
// A list with commas between its items, each one of:
//   rx, tx                              position, x y z [1/m]
//   rx_orientation, tx_orientation      yaw pitch roll [1/rad]
//   rx_array_turn, tx_array_turn        the same about the origin of the antenna's array [1/rad]
//   NAME (or object.NAME)               translation of that object, x y z [1/m]
// each with ".0", ".1" or ".2" behind it for one of the three only, and
//   rx_gain, tx_gain                    amplitude factor of the antenna
//   offset.NAME                         of each surface of the object along its normal [1/m]
//   eps_r.NAME, sigma.NAME, thickness.NAME   of that material
// The three are named NAME.0 to NAME.2 in the result, an object's surfaces offset.NAME.0 and so on.
#pragma once

#include <string>
#include <vector>

#include "engine/base/expected.h"
#include "engine/scene/scene.h"
#include "engine/trace/parameter.h"

namespace rayloc {

struct NamedParameter {
  std::string name;  // "rx.0", "table.2", "eps_r.wood"
  Parameter parameter;
};

// Errors (kUsage) name the unknown name and the closest valid one.
Expected<std::vector<NamedParameter>> parse_parameters(const std::string& names,
                                                       const Scene& scene);

}  // namespace rayloc
