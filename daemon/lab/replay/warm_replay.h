// A replay that begins in the middle of a recording, as a worker that takes over a site does, and
// the file of handed-over records.
#pragma once

#include <chrono>
#include <string>

#include "daemon/pipeline/warm/warm_start.h"
#include "engine/base/expected.h"
#include "engine/base/timestamp.h"

namespace rayloc::replay {

struct WarmOptions {
  // Time as in locations, "2024-06-10T06:13:35.5Z"; empty: the beginning, or the end of the
  // records.
  std::string from;
  Duration warm_up = std::chrono::seconds(5);  // processed before that, without results
  std::string carried;                         // file of carried_line(); empty: no records
};

// Returns a default start if the replay covers the whole recording. Errors: a time that cannot be
// parsed (kUsage); a file that cannot be read, with the line; records that begin after `from`.
Expected<WarmStart> warm_start_of(const WarmOptions& replay);

// A record as a line of the file, with its newline.
std::string carried_line(const Carried& carried);

}  // namespace rayloc::replay
