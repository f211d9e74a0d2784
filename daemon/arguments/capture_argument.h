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

// Whether an access point may be named again: several recordings are a sequence, but what is
// written or listened to is one.
enum class PerAccessPoint : std::uint8_t { kOne, kSeveral };

// The captures with every access point resolved to one of `ids`: the id may be left out when there
// is one. Errors: an unknown id, a missing id, an access point named twice where each has one file.
Expected<std::vector<CaptureArgument>> resolve_captures(
    const std::vector<std::string>& arguments,
    const std::vector<std::string>& ids,
    PerAccessPoint files = PerAccessPoint::kOne);

// What one access point recorded, in one file or several; in which order they were made the files
// themselves tell (capture/source/recording_plan.h).
struct RecordingArgument {
  std::string access_point;
  std::vector<std::string> files;  // at least one
};

// The captures by access point, in the order in which these are named first.
std::vector<RecordingArgument> recordings_of(const std::vector<CaptureArgument>& captures);

// The same where no site says which access points there are: files of one `AP=` belong together,
// and each without it is a recording of its own.
std::vector<RecordingArgument> recordings_of_any(const std::vector<std::string>& arguments);

// "a.pcap, b.pcap"
std::string files_text(const RecordingArgument& recording);

}  // namespace rayloc::cli
