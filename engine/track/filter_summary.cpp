#include "engine/track/filter_summary.h"

#include <algorithm>
#include <cmath>

#include "engine/grid/cell_window.h"

namespace rayloc {
namespace {

constexpr double kMinMass = 1e-300;  // a probability, chosen: keeps its logarithm finite

}  // namespace

std::vector<double> log_masses(std::vector<double> mass) {
  for (double& value : mass) {
    value = std::log(std::max(value, kMinMass));
  }
  return mass;
}

void summarise_filter(const GridFilter& filter,
                      const Grid& grid,
                      PosteriorOptions options,
                      const RefinedCells& within,
                      LocationEstimate& location) {
  const CellWindow& window = filter.window();
  RefinedCells in_window;
  for (const auto& [cell, mass] : within) {
    if (const auto number = window.number(cell, grid)) {
      in_window.emplace_back(*number, mass);
    }
  }
  options.outlier = 1.0 - (1.0 - filter.away()) * (1.0 - options.outlier);
  options.cells_of_room = static_cast<double>(grid.size());
  summarise_posterior(
      window.grid_of(grid), log_masses(filter.mass()), options, location, in_window);
}

}  // namespace rayloc
