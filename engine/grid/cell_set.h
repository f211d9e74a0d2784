// CellSet: cells that represent a whole grid, and the number of cells that each one represents.
//
// A map over a set has one value per cell of it, in the order of the set.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "engine/grid/grid.h"

namespace rayloc {

// Number of cells of a grid that each value of a map represents: 1 for the first `ones` values,
// which are evaluated themselves, and `others` for the rest, a sample of the remaining cells.
struct CellWeights {
  std::size_t ones = std::numeric_limits<std::size_t>::max();
  double others = 1.0;

  double of(std::size_t n) const { return n < ones ? 1.0 : others; }
};

struct CellSet {
  std::vector<std::size_t> cells;  // empty: all cells of the grid, in their order
  CellWeights weights;

  // `cells` represent themselves; `sample` represents the rest of a grid that has `represented`
  // cells. An empty sample represents no cells.
  static CellSet with_sample(std::span<const std::size_t> cells,
                             std::span<const std::size_t> sample,
                             std::size_t represented) {
    CellSet set;
    set.cells.assign(cells.begin(), cells.end());
    set.cells.insert(set.cells.end(), sample.begin(), sample.end());
    if (!cells.empty() && !sample.empty()) {
      const double rest = static_cast<double>(represented) - static_cast<double>(cells.size());
      set.weights = {cells.size(), rest / static_cast<double>(sample.size())};
    }
    return set;
  }

  bool is_all() const { return cells.empty(); }
  // Cell of the grid for entry n, the number of entries, and how many of them, the first ones,
  // represent themselves.
  std::size_t cell(std::size_t n) const { return cells.empty() ? n : cells[n]; }
  std::size_t size(const Grid& grid) const { return cells.empty() ? grid.size() : cells.size(); }
  std::size_t ones(const Grid& grid) const { return std::min(weights.ones, size(grid)); }
};

}  // namespace rayloc
