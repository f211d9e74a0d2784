#pragma once

#include <string>

namespace rayloc::cli {

// Text for people: "0.0 s", "9.9 s", "119 s", "2 min", "2 h".
std::string age_text(double seconds);

}  // namespace rayloc::cli
