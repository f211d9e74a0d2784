// Completion of `rayloc` command lines by bash and zsh.
#pragma once

#include <string>

#include "daemon/cli/command/command_description.h"

namespace rayloc::cli {

// A script to be sourced by bash, without other dependencies.
std::string bash_completion(const Command& rayloc);

// A file `_rayloc` for a folder of zsh's $fpath.
std::string zsh_completion(const Command& rayloc);

}  // namespace rayloc::cli
