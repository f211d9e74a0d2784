#include "daemon/cli/verbs.h"

namespace rayloc::cli {

// extern const Verb kFrames;  // frames.cpp

std::span<const Verb> verbs() { return {}; }

}  // namespace rayloc::cli
