// `[AP=]FILE`: argument of many verbs, a recording and the access point that made it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/expected.h"

namespace rayloc {

struct CaptureArgument {
  std::string access_point;  // id; empty if omitted
  std::string file;          // "-" is standard input
};

// Splits at the first '=' if the part before it can be an access point's id (letters, digits, '-'
// and '_'), so that a path with '=' in it stays a path.
CaptureArgument parse_capture_argument(const std::string& text);

// Selects how often an access point may be named: several recordings are a sequence, while an
// output or a live source is single.
enum class PerAccessPoint : std::uint8_t { kOne, kSeveral };

// The captures with every access point resolved to one of `ids`: the id may be omitted if there is
// only one. Errors: an unknown id, a missing id, an access point named twice if each has one file.
Expected<std::vector<CaptureArgument>> resolve_captures(
    const std::vector<std::string>& arguments,
    const std::vector<std::string>& ids,
    PerAccessPoint files = PerAccessPoint::kOne);

// Recordings of one access point, in one file or several; the files themselves contain their order
// (capture/source/recording_plan.h).
struct RecordingArgument {
  std::string access_point;
  std::vector<std::string> files;  // at least one
};

// The captures by access point, in the order in which these are first named.
std::vector<RecordingArgument> recordings_of(const std::vector<CaptureArgument>& captures);

// The same without a site's list of access points: files of one `AP=` belong together, and each
// file without it is a recording of its own.
std::vector<RecordingArgument> recordings_of_any(const std::vector<std::string>& arguments);

// "a.pcap, b.pcap"
std::string files_text(const RecordingArgument& recording);

}  // namespace rayloc
