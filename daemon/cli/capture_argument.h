// `[AP=]FILE`: a recording and the access point that made it, as many verbs take it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/expected.h"

namespace rayloc::cli {

struct CaptureArgument {
  std::string access_point;  // id, or empty when it was left out
  std::string file;          // "-" is standard input
};

// Splits at the first '=' when what stands before it can be an access point's id (letters, digits,
// '-' and '_'), so that a path with '=' in it stays a path.
CaptureArgument parse_capture_argument(const std::string& text);

// Whether an access point may be named again: a survey that was interrupted has several recordings.
enum class PerAccessPoint : std::uint8_t { kOne, kSeveral };

// The captures with every access point resolved to one of `ids`: the id may be left out when there
// is one. Errors: an unknown id, a missing id, an access point named twice where each has one file.
Expected<std::vector<CaptureArgument>> resolve_captures(
    const std::vector<std::string>& arguments,
    const std::vector<std::string>& ids,
    PerAccessPoint files = PerAccessPoint::kOne);

}  // namespace rayloc::cli
