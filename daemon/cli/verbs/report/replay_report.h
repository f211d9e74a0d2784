// Prints the progress and the outcome of `rayloc replay` on standard error.
#pragma once

#include <string>

#include "daemon/lab/replay/replay.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

// Prints, unless `quiet`, the recordings, the counters and `no_fix`, a line with the reasons for
// snapshots without a position (empty: none). Returns an Error for every source that ended
// prematurely, and if packets contain no CSI at all.
Expected<void> report_replay(const replay::Summary& summary, const std::string& no_fix, bool quiet);

void print_replay_notices(const replay::Notices& notices);

}  // namespace rayloc::cli
