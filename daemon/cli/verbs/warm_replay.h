// A replay that begins in the middle of a recording, as a worker that takes over a site does: its
// options, and the file of handed-over records.
#pragma once

#include <string>

#include "daemon/cli/command/option_parser.h"
#include "daemon/pipeline/warm/warm_start.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

struct WarmReplayArguments {
  std::string from;          // empty: the beginning, or the end of the records
  double warm_up = 5.0;      // [s]
  std::string carried;       // file; empty: no carried records
  std::string carried_out;   // file; empty: not written
  double carried_every = 1;  // [s]
};

void add_warm_replay_options(OptionParser& app, WarmReplayArguments& arguments);

// Returns empty if the replay covers the whole recording.
Expected<WarmStart> warm_start_of(const WarmReplayArguments& arguments);

// A record as a line of the file.
std::string carried_line(const Carried& carried);

}  // namespace rayloc::cli
