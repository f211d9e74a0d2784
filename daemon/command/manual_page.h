// The manual page rayloc(1), made of what --help says.
#pragma once

#include <string>

#include "daemon/command/command_description.h"

namespace rayloc::cli {

// In the man macros of roff.
std::string manual_page(const Command& rayloc);

}  // namespace rayloc::cli
