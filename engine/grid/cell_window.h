// CellWindow: a rectangle of the cells of a grid.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "engine/grid/grid.h"

namespace rayloc {

struct CellWindow {
  std::size_t first_x = 0;
  std::size_t first_y = 0;
  std::size_t count_x = 0;
  std::size_t count_y = 0;

  static CellWindow all_of(const Grid& grid) { return {0, 0, grid.count_x, grid.count_y}; }
  bool is_all_of(const Grid& grid) const { return size() == grid.size(); }
  std::size_t size() const { return count_x * count_y; }

  // Index in the grid of cell `number` of the window, and the inverse; empty outside it.
  std::size_t cell(std::size_t number, const Grid& grid) const {
    return (first_x + number / count_y) * grid.count_y + first_y + number % count_y;
  }
  std::optional<std::size_t> number(std::size_t cell, const Grid& grid) const {
    const std::size_t x = cell / grid.count_y - first_x;  // wraps below the first
    const std::size_t y = cell % grid.count_y - first_y;
    return x < count_x && y < count_y ? std::optional(x * count_y + y) : std::nullopt;
  }

  // Grid of the window's cells only.
  Grid grid_of(const Grid& grid) const {
    Grid part = grid;
    part.first.x += grid.step_x * static_cast<double>(first_x);
    part.first.y += grid.step_y * static_cast<double>(first_y);
    part.count_x = count_x;
    part.count_y = count_y;
    return part;
  }
};

// The first and one past the last of the entries that remain when at most `out` is removed at each
// end; one entry always remains. REQUIRES: an entry.
std::array<std::size_t, 2> kept_range(const std::vector<double>& mass, double out);

}  // namespace rayloc
