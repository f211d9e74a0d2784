#include "daemon/cli/verbs.h"

#include <array>

namespace rayloc::cli {

// One row a verb, in the order of `rayloc --help`.
extern const Verb kFrames;       // frames.cpp
extern const Verb kSub;          // sub.cpp
extern const Verb kCheckConfig;  // check_config.cpp
extern const Verb kConfig;       // config.cpp

std::span<const Verb> verbs() {
  static const std::array kVerbs = {
      kFrames,
      kSub,
      kCheckConfig,
      kConfig,
  };
  return kVerbs;
}

}  // namespace rayloc::cli
