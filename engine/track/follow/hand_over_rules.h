// The rules by which a target changes between the grid and its cloud. Each is a function of its
// arguments alone.
//
// A cloud narrows to the places that it has. Where the grid's distribution is broad, a cloud made
// of it soon has one of many places, and often a wrong one. So the grid continues until its
// distribution is narrow, and takes the target back when that of the cloud is broad, when the
// target is at none of the cloud's places, or when another place of the room explains the moments
// clearly better.
#pragma once

#include <chrono>
#include <span>

#include "engine/base/timestamp.h"
#include "engine/localize/search_area.h"
#include "engine/track/free_space.h"
#include "engine/track/grid_filter.h"
#include "engine/track/place_cloud.h"

namespace rayloc {

struct HandOverOptions {
  Duration acquire_for = std::chrono::seconds(2);  // of frames since the place was unknown
  // Widths of a distribution, in cells of 5 x 5 cm of equal mass (exp of the entropy). The grid
  // hands over below the first and takes back above the second, or at no width with 0; the factor
  // between them keeps a target from changing back and forth. Chosen: 400 are a square metre, five
  // peaks of 10 cm standard deviation, and 15 of the first places of a cloud are in each cell.
  double max_cells = 400.0;
  double return_cells = 800.0;
  // Probabilities from which on the grid takes the target back: it is at none of the cloud's
  // places, and beside the area.
  double max_away = 0.5;
  double max_outside = SearchArea::kMaxOutlierShare;
  // Share of the mass that a grid made of a cloud spreads over the room: at least this much, ...
  double least_spread = 0.05;
  // ... and as much as the cloud keeps when another place is the reason: the grid decides.
  double rival_spread = 0.5;

  // A rival is the best place of the room farther than this from the cloud [m]. Each evaluation of
  // the whole room changes its lead by the difference to the best place near the cloud, at most
  // `rival_most` in either direction, less the handicap [nat of the tempered log-likelihood].
  double rival_distance = 0.5;
  // Chosen: about what the best of many wrong places gains over the right one by chance.
  double rival_handicap = 1.0;
  // Chosen: as much as the outlier probability of a moment, 0.05, lets it rule out.
  double rival_most = 3.0;
  // Lead above which the grid takes over. Above rival_most - rival_handicap: one moment is never
  // enough. With one access point each moment has peaks everywhere, but not the same ones.
  double rival_margin = 3.0;
};

// Width in cells of 5 x 5 cm of a distribution over cells of `cell_area` [m^2]; 0 without any mass.
// mass: of any scale.
double effective_cells(std::span<const double> mass, double cell_area);
// That of a cloud, in squares of about 10 cm: places are too few for smaller ones.
double effective_cells(const PlaceCloud& cloud, const Grid& grid);

// True if a cloud may follow the target. acquired: time of frames since its place was unknown.
// REQUIRES: `filter` has this grid, !filter.is_compact().
bool hands_over(const GridFilter& filter,
                const Grid& grid,
                Duration acquired,
                const HandOverOptions& options);

struct CloudWidth {
  double cells = 0.0;    // effective ones
  double away = 0.0;     // probability that the target is at none of the places
  double outside = 0.0;  // probability that it is beside the area
};
// True if the grid takes the target back.
bool is_taken_back(const CloudWidth& cloud, const HandOverOptions& options);
// Share of the mass that the grid spreads over the room then. away: as above.
double spread_of(double away, bool has_rival, const HandOverOptions& options);

// The best log-likelihoods of a moment near a cloud, and farther than `distance` from it; -inf
// without a cell.
struct RoomBest {
  double near = 0.0;
  double rival = 0.0;
};
// log_likelihood: [cell of the room].
RoomBest best_beside(const PlaceCloud& cloud,
                     const FreeSpace& space,
                     std::span<const double> log_likelihood,
                     double distance);
// The lead of a rival, at least 0, after an evaluation of the whole room. exponent: that of the
// likelihood. weight: share of the moment that is new, in [0, 1].
double rival_lead(double lead,
                  const RoomBest& best,
                  double exponent,
                  double weight,
                  const HandOverOptions& options);
bool is_rival_better(double lead, const HandOverOptions& options);
// Time to the next evaluation: soon while a rival leads, otherwise twice as long as the last one,
// up to kWholeRoomPeriod.
Duration next_search_period(Duration last, double lead);

}  // namespace rayloc
