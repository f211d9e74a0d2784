// NumberRange: the valid values of a key in a file.
#pragma once

#include <limits>
#include <string_view>

namespace rayloc {

struct NumberRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::string_view unit = {};  // for messages: "m", "degrees"
};

}  // namespace rayloc
