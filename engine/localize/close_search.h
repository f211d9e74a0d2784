// The close search: the best cells of a room's map, looked at place by place.
//
// Where the height is known, the places of a cell are a lattice at that height. Where it is not,
// the best cells are looked at layer by layer of heights first, and of these boxes of a cell and a
// layer the best are looked at place by place.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/localize/heard_array.h"
#include "engine/posterior/access_point_fusion.h"
#include "engine/posterior/posterior.h"
#include "engine/posterior/room_map.h"
#include "engine/room/height_layers.h"

namespace rayloc {

// What is known of a place before a burst; empty: nothing but the room's priors.
struct SearchFocus {
  std::vector<double> log_prior;     // of `cells`, natural logarithm
  std::vector<double> layer_weight;  // [layer], probability
  std::vector<std::size_t> cells;    // where the device may be; empty: in all cells of the room
  // The best boxes are looked at by few of their places first, and what it costs is bounded;
  // otherwise by all of them, as Localizer::locate() does. What is looked for in some cells is so
  // in any case.
  bool is_quick = false;
  // Of all other cells a sample, which stands for them. REQUIRES: not empty where `cells` is not.
  std::vector<std::size_t> others;
};

// The cells that a burst is compared with, by their numbers in a map.
struct ComparedCells {
  std::vector<std::size_t> cells;  // empty: all cells of the room, in their order
  std::size_t close = 0;           // so many of the first may be looked at closely
  CellWeights weights;

  std::size_t cell(std::size_t n) const { return cells.empty() ? n : cells[n]; }
  std::size_t size(const RoomGrid& grid) const {
    return cells.empty() ? grid.size() : cells.size();
  }
};
ComparedCells compared_cells(const RoomGrid& grid, const SearchFocus& focus);

struct CloseSearch {
  const RoomGrid& grid;
  const HeightLayers& heights;
  double wavelength;  // [m]
  std::span<const HeardArray> heard;
  std::span<const double> nowhere;  // [array], what all are compared with
  const AccessPointFusion& fusion;
  double likelihood_exponent;
  const SearchFocus& focus;
  const ComparedCells& compared;  // what the map is of
};

// The log-likelihood of cells that are looked at becomes that of the mean over their places.
void search_closely(const CloseSearch& search, RoomMap& map);

}  // namespace rayloc
