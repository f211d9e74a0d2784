// RefusedInput: something that was given and not used, and why.
#pragma once

#include <string>

namespace rayloc {

struct RefusedInput {
  std::string what;  // "points.csv:17 ap2"
  std::string reason;
};

}  // namespace rayloc
