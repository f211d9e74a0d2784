// Text of an Embree error.
#pragma once

#include <string>

#include <embree3/rtcore.h>

#include "engine/base/expected.h"

namespace rayloc {

inline tl::unexpected<Error> embree_error(RTCError error) {
  if (error == RTC_ERROR_OUT_OF_MEMORY) {
    return make_error(ErrorKind::kUnavailable,
                      "no memory for the search tree of the room; raise the limit of memory "
                      "(ulimit -v, MemoryMax=) or give the machine more");
  }
  return make_error(
      ErrorKind::kInternal,
      "Embree cannot be used (error " + std::to_string(static_cast<int>(error)) + ")");
}

}  // namespace rayloc
