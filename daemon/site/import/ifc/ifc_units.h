// The unit of length of an IFC file.
#pragma once

#include "daemon/site/import/ifc/step_text.h"

namespace rayloc {

// [m] per unit of the lengths that assimp returns: 1 for a unit of the SI, which assimp applies;
// 0.3048 for feet, which it leaves out. Thread-safe. `step` has passed check_ifc().
double ifc_metres(const StepText& step);

}  // namespace rayloc
