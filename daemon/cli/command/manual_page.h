// The manual page rayloc(1), generated from the --help texts.
#pragma once

#include <string>

#include "daemon/cli/command/command_description.h"

namespace rayloc::cli {

// In the man macros of roff.
std::string manual_page(const Command& rayloc);

}  // namespace rayloc::cli
