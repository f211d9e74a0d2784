// Numbers as arguments: "1.2,-0.4,2.1".
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>

#include "engine/base/expected.h"
#include "engine/base/vec3.h"

namespace rayloc::cli {

// Fills `values` from numbers between commas. An Error (kUsage) that names `option` and what to
// write (`example`) when there are more or fewer, or when one is no finite number.
Expected<void> parse_number_list(const std::string& option,
                                 const std::string& text,
                                 const std::string& example,
                                 std::span<double> values);

// "x,y,z" in metres.
Expected<Vec3d> parse_point(const std::string& option, const std::string& text);

}  // namespace rayloc::cli
