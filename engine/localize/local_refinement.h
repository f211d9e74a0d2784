// The local refinement: evaluates the best cells of a room's map place by place.
//
// With a known height, the places of a cell are a lattice at that height. With an unknown height,
// the best cells are evaluated layer by layer first, and the best of these boxes (a cell and a
// layer) are then evaluated place by place.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/grid/cell_set.h"
#include "engine/grid/grid.h"
#include "engine/localize/array_observation.h"
#include "engine/posterior/access_point_fusion.h"
#include "engine/posterior/room_map.h"

namespace rayloc {

// Prior on the position before a burst; empty: only the room's priors.
struct SearchFocus {
  std::vector<double> log_prior;     // of `cells`, natural logarithm
  std::vector<double> layer_weight;  // [layer], probability
  std::vector<std::size_t> cells;    // cells that may hold the device; empty: all cells of the room
  // Evaluates the best boxes at a few of their places first, at a bounded cost; otherwise at all of
  // their places, as Localizer::locate() does. A search that is restricted to some cells is always
  // quick.
  bool is_quick = false;
  // A sample that represents all other cells. REQUIRES: not empty unless `cells` is empty.
  std::vector<std::size_t> others;
};

// The cells that a burst is compared with; those of the focus may be refined.
CellSet compared_cells(const Grid& grid, const SearchFocus& focus);

struct LocalRefinement {
  const Grid& grid;
  double wavelength;  // [m]
  std::span<const ArrayObservation> received;
  std::span<const double> null_model;  // [array], log-likelihood of the null model
  const AccessPointFusion& fusion;
  double likelihood_exponent;
  const SearchFocus& focus;
  const CellSet& compared;  // the cells of the map
};

// Replaces the log-likelihood of refined cells by that of the mean over their places.
void refine_locally(const LocalRefinement& search, RoomMap& map);

}  // namespace rayloc
