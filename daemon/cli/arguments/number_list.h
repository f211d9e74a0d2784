// Numbers as arguments: "1.2,-0.4,2.1".
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>

#include "engine/base/expected.h"
#include "engine/base/vec3.h"

namespace rayloc::cli {

// Fills `values` from comma-separated numbers. Returns an Error (kUsage) that names `option` and
// the expected form (`example`) if the count differs or a value is not a finite number.
Expected<void> parse_number_list(const std::string& option,
                                 const std::string& text,
                                 const std::string& example,
                                 std::span<double> values);

// "x,y,z" in metres.
Expected<Vec3d> parse_point(const std::string& option, const std::string& text);

}  // namespace rayloc::cli
