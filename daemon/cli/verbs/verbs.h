// The list of verbs; each is declared in the file of its name (frames.cpp, replay.cpp, ...).
#pragma once

#include <span>

#include "daemon/cli/command/verb.h"

namespace rayloc::cli {

std::span<const Verb> verbs();

}  // namespace rayloc::cli
