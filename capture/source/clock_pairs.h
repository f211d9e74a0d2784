// Classifies the jumps of a recording's time stamps that were clock steps. Time does not go back,
// so a backward jump is a clock step. A forward jump followed by an equal backward jump is two
// clock steps, and so is the reverse order.
#pragma once

#include <cstdint>
#include <vector>

#include "capture/source/record_times.h"

namespace rayloc {

// Sets was_set. A jump undoes the nearest earlier one whose size is opposite to its own, within
// `gap`. Returns the work: steps of the searches, of the order of n log n.
std::uint64_t mark_clocks_set(std::vector<ClockJump>& jumps, Duration gap);

}  // namespace rayloc
