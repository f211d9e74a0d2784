// The unit of length of an IFC file.
#pragma once

#include <string_view>

#include "daemon/site/import/ifc/step_text.h"

namespace rayloc {

// [m] per unit of the lengths that assimp returns: 1 for a unit of the SI, which assimp applies;
// 0.3048 for feet, which it leaves out; finite and above 0. Thread-safe. `step` has passed
// check_ifc().
double ifc_metres(const StepText& step);

// The number of IFCLENGTHMEASURE(0.3048), or of 0.3048; 0 for another text. Thread-safe.
double ifc_measure(std::string_view value);

}  // namespace rayloc
