// Text for manual pages, in the man macros of roff.
#pragma once

#include <string>
#include <string_view>

namespace rayloc {

// Escapes one line for literal output: backslashes stay, dashes can be typed, and a dot or a quote
// at the beginning is no request.
std::string roff(std::string_view line);

}  // namespace rayloc
