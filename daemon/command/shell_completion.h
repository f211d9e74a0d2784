// Completion of `rayloc` command lines by bash and zsh.
#pragma once

#include <string>

#include "daemon/command/command_description.h"

namespace rayloc::cli {

// A script for bash to source; needs nothing but bash.
std::string bash_completion(const Command& rayloc);

// A file `_rayloc` for a folder of zsh's $fpath.
std::string zsh_completion(const Command& rayloc);

}  // namespace rayloc::cli
