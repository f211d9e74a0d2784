// Which jumps of a recording's time stamps were a clock that was set. Time does not go back: the
// clock was set. Where it went forward and comes back by as much, it was set both times, and so
// where it went back and comes forward again.
#pragma once

#include <cstdint>
#include <vector>

#include "capture/source/record_times.h"

namespace rayloc {

// Sets was_set. A jump undoes the nearest one before it whose size is the opposite of its own,
// within `gap`. Returns the work: steps of the searches, of the order of n log n.
std::uint64_t mark_clocks_set(std::vector<ClockJump>& jumps, Duration gap);

}  // namespace rayloc
