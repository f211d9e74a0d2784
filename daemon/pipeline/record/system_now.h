// The machine's clock as event time: for names and stamps of files, never for an estimate.
#pragma once

#include "engine/base/timestamp.h"

namespace rayloc {

inline Timestamp system_now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

}  // namespace rayloc
