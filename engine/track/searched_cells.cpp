#include "engine/track/searched_cells.h"

#include <algorithm>
#include <cmath>

#include "engine/base/highest.h"
#include "engine/grid/cell_window.h"
#include "engine/grid/grid.h"

namespace rayloc {
namespace {

constexpr double kNotCompared = 1e-3;  // a probability, chosen: share of the window's mass
constexpr std::size_t kOthers = 64;    // a count, chosen: cells that represent the rest of the room

// `cells`: in ascending order.
std::vector<std::size_t> sample_of_others(const FreeSpace& space,
                                          const std::vector<std::size_t>& cells,
                                          std::size_t burst) {
  const Grid& grid = space.grid;
  const auto stride = static_cast<std::size_t>(
      std::max(1.0, std::round(std::sqrt(static_cast<double>(grid.size()) / kOthers))));
  // The step from one lattice to the next is about the golden section of their number.
  const std::size_t lattices = stride * stride;
  const std::size_t turn =
      burst % lattices * static_cast<std::size_t>(0.618 * static_cast<double>(lattices)) % lattices;
  std::vector<std::size_t> others;
  for (std::size_t x = turn / stride; x < grid.count_x; x += stride) {
    for (std::size_t y = turn % stride; y < grid.count_y; y += stride) {
      const std::size_t cell = x * grid.count_y + y;
      if (space.free[cell] != 0 && !std::binary_search(cells.begin(), cells.end(), cell)) {
        others.push_back(cell);
      }
    }
  }
  return others;
}

}  // namespace

SearchedCells searched_cells(const GridFilter& filter, const FreeSpace& space, std::size_t turn) {
  const CellWindow& window = filter.window();
  SearchedCells searched;
  if (window.is_all_of(space.grid)) {
    return searched;
  }
  const std::vector<double> mass = filter.mass();
  std::vector<std::size_t> numbers = highest(mass, mass.size());
  double left = 1.0;
  std::size_t count = 0;
  while (count < numbers.size() && left > kNotCompared) {
    left -= mass[numbers[count++]];
  }
  numbers.resize(count);
  std::sort(numbers.begin(), numbers.end());
  searched.cells.reserve(count);
  searched.mass.reserve(count);
  for (const std::size_t number : numbers) {
    searched.cells.push_back(window.cell(number, space.grid));
    searched.mass.push_back(mass[number]);
  }
  searched.others = sample_of_others(space, searched.cells, turn);
  return searched.others.empty() ? SearchedCells{} : searched;
}

}  // namespace rayloc
