// LookedCells: the cells that a burst of a target is compared with, told by the filter that follows
// it: where the target may be, and a lattice that stands for the rest of the room.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/track/free_space.h"
#include "engine/track/grid_filter.h"

namespace rayloc {

// Probabilities, chosen: what the window of a filter that is followed leaves out ...
inline constexpr double kOutOfWindow = 1e-4;
// ... and of being out of it, from which on the whole room is looked at.
inline constexpr double kMostAway = 0.02;
// Chosen: from one look at the whole room to the next, after the target might have been anywhere. A
// hill that was followed wrongly explains enough to be followed on, and most such are chosen where
// little is known.
inline constexpr Duration kFirstWholeRoomPeriod = std::chrono::seconds(1);
// Chosen: each takes twice as long as the one before, up to this.
inline constexpr Duration kWholeRoomPeriod = std::chrono::seconds(5);

struct LookedCells {
  std::vector<std::size_t> cells;   // of the room, in order; empty: all of it
  std::vector<double> mass;         // of each of them, by the filter
  std::vector<std::size_t> others;  // a lattice over the rest

  bool is_all() const { return cells.empty(); }
};

// `turn`: a count of bursts. Every burst has another lattice, so that in time all of the room is
// looked at.
LookedCells looked_cells(const GridFilter& filter, const FreeSpace& space, std::size_t turn);

}  // namespace rayloc
