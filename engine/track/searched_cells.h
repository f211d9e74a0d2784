// SearchedCells: the cells that a target's burst is compared with, chosen from its filter: the
// cells that may hold the target, and a lattice that represents the rest of the room.
#pragma once

#include <chrono>
#include <cstddef>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/track/free_space.h"
#include "engine/track/grid_filter.h"

namespace rayloc {

// Probabilities, chosen: mass left out of the window of a filter that is followed ...
inline constexpr double kOutOfWindow = 1e-4;
// ... and mass outside the window from which on the whole room is evaluated.
inline constexpr double kMaxAway = 0.02;
// Chosen: time between two evaluations of the whole room, after the target might have been
// anywhere. A wrongly followed peak explains enough to be followed on, and most such peaks are
// chosen while little is known of the position.
inline constexpr Duration kFirstWholeRoomPeriod = std::chrono::seconds(1);
// Chosen: each period is twice as long as the one before, up to this.
inline constexpr Duration kWholeRoomPeriod = std::chrono::seconds(5);

// True if the whole room is to be evaluated again. By the time of the frames, not by the begin of
// the track, so that a successor evaluates it at the same times.
inline bool is_search_due(Timestamp now, Timestamp last, Duration period, Duration phase) {
  const auto number = [&](Timestamp time) { return (time.time_since_epoch() + phase) / period; };
  return number(now) != number(last);
}

struct SearchedCells {
  std::vector<std::size_t> cells;   // of the room, in ascending order; empty: all cells
  std::vector<double> mass;         // mass of each of them in the filter
  std::vector<std::size_t> others;  // a lattice over the remaining cells

  bool is_all() const { return cells.empty(); }
};

// `turn`: number of the burst. Every burst uses another lattice, so that all cells of the room are
// evaluated over time.
SearchedCells searched_cells(const GridFilter& filter, const FreeSpace& space, std::size_t turn);

}  // namespace rayloc
