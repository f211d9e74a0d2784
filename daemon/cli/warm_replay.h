// A replay that begins in the middle, as a worker does that takes a site over: its options, and
// the file of records that goes from one to the next.
#pragma once

#include <string>

#include "daemon/command/option_parser.h"
#include "daemon/pipeline/warm/warm_start.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

struct WarmReplayArguments {
  std::string from;          // empty: from the beginning, or from where the records end
  double warm_up = 5.0;      // [s]
  std::string carried;       // file; empty: nobody carried anything
  std::string carried_out;   // file; empty: not written
  double carried_every = 1;  // [s]
};

void add_warm_replay_options(OptionParser& app, WarmReplayArguments& arguments);

// Nothing: the replay is of the whole recording.
Expected<WarmStart> warm_start_of(const WarmReplayArguments& arguments);

// A record as a line of the file.
std::string carried_line(const Carried& carried);

}  // namespace rayloc::cli
