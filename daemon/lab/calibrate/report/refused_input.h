// RefusedInput: an input that was not used, with the reason.
#pragma once

#include <string>

namespace rayloc {

struct RefusedInput {
  std::string what;  // "points.csv:17 ap2"
  std::string reason;
};

}  // namespace rayloc
