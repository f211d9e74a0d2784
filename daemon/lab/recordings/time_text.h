// Times as text.
#pragma once

#include <string>

#include "engine/base/timestamp.h"

namespace rayloc {

// RFC 3339 in UTC, "2018-05-05T06:11:11.306626Z"; nine decimals if there are nanoseconds.
std::string time_text(Timestamp time);

}  // namespace rayloc
