#include "engine/track/follow/hand_over_rules.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "engine/base/highest.h"
#include "engine/posterior/posterior.h"
#include "engine/track/searched_cells.h"

namespace rayloc {
namespace {

constexpr double kUnitArea = 0.05 * 0.05;  // [m^2], of the cells in which widths are stated
constexpr double kSquare = 0.1;            // [m], chosen: side of the squares of a cloud
constexpr double kOfCloud = 0.95;          // a probability, chosen: of the cells that a cloud is in

std::size_t cells_of(double length, double step) {
  return static_cast<std::size_t>(std::max(1.0, std::round(length / step)));
}

// 1: within the distance of a cell that the cloud is in; single places that strayed do not count.
std::vector<char> cells_near(const PlaceCloud& cloud, const Grid& grid, double distance) {
  std::vector<double> mass(grid.size());
  const std::vector<float> weights = cloud.weights();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::size_t cell = cell_of(cloud, i, grid);
    if (cell < grid.size()) {
      mass[cell] += static_cast<double>(weights[i]);
    }
  }
  const std::size_t reach_x = cells_of(distance, grid.step_x);
  const std::size_t reach_y = cells_of(distance, grid.step_y);
  std::vector<char> near(grid.size(), 0);
  double left = kOfCloud;
  for (const std::size_t cell : highest(mass, mass.size())) {
    if (left <= 0.0 || mass[cell] <= 0.0) {
      break;
    }
    left -= mass[cell];
    const std::size_t x = cell / grid.count_y;
    const std::size_t y = cell % grid.count_y;
    const std::size_t last_x = std::min(x + reach_x, grid.count_x - 1);
    const std::size_t last_y = std::min(y + reach_y, grid.count_y - 1);
    for (std::size_t i = x - std::min(x, reach_x); i <= last_x; ++i) {
      const auto row = near.begin() + static_cast<std::ptrdiff_t>(i * grid.count_y);
      std::fill(row + static_cast<std::ptrdiff_t>(y - std::min(y, reach_y)),
                row + static_cast<std::ptrdiff_t>(last_y + 1),
                char{1});
    }
  }
  return near;
}

}  // namespace

double effective_cells(std::span<const double> mass, double cell_area) {
  double all = 0.0;
  for (const double one : mass) {
    all += one;
  }
  if (!(all > 0.0)) {
    return 0.0;
  }
  std::vector<double> share(mass.begin(), mass.end());
  for (double& one : share) {
    one /= all;
  }
  return effective_cells(share) * cell_area / kUnitArea;
}

double effective_cells(const PlaceCloud& cloud, const Grid& grid) {
  const std::size_t block_x = cells_of(kSquare, grid.step_x);
  const std::size_t block_y = cells_of(kSquare, grid.step_y);
  const std::size_t rows = grid.count_y / block_y + 1;
  std::vector<double> mass((grid.count_x / block_x + 1) * rows);
  const std::vector<float> weights = cloud.weights();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::size_t cell = cell_of(cloud, i, grid);
    if (cell < grid.size()) {
      mass[cell / grid.count_y / block_x * rows + cell % grid.count_y / block_y] +=
          static_cast<double>(weights[i]);
    }
  }
  const auto cells = static_cast<double>(block_x * block_y);
  return effective_cells(mass, cells * grid.step_x * grid.step_y);
}

bool hands_over(const GridFilter& filter,
                const Grid& grid,
                Duration acquired,
                const HandOverOptions& options) {
  if (acquired < options.acquire_for || filter.away() > kMaxAway) {
    return false;
  }
  return options.max_cells <= 0.0 ||
         effective_cells(filter.mass(), grid.step_x * grid.step_y) <= options.max_cells;
}

bool is_taken_back(const CloudWidth& cloud, const HandOverOptions& options) {
  const bool is_broad = options.return_cells > 0.0 && cloud.cells > options.return_cells;
  return is_broad || cloud.away > options.max_away || cloud.outside > options.max_outside;
}

double spread_of(double away, bool has_rival, const HandOverOptions& options) {
  return std::max(away, has_rival ? options.rival_spread : options.least_spread);
}

RoomBest best_beside(const PlaceCloud& cloud,
                     const FreeSpace& space,
                     std::span<const double> log_likelihood,
                     double distance) {
  const std::vector<char> near = cells_near(cloud, space.grid, distance);
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  RoomBest found{kNone, kNone};
  for (std::size_t cell = 0; cell < near.size(); ++cell) {
    if (space.free[cell] != 0) {
      double& best = near[cell] != 0 ? found.near : found.rival;
      best = std::max(best, log_likelihood[cell]);
    }
  }
  return found;
}

double rival_lead(double lead,
                  const RoomBest& best,
                  double exponent,
                  double weight,
                  const HandOverOptions& options) {
  if (!std::isfinite(best.rival)) {  // the cloud is near every cell
    return 0.0;
  }
  const double gain =
      std::clamp(exponent * (best.rival - best.near), -options.rival_most, options.rival_most);
  return std::max(0.0, lead + weight * (gain - options.rival_handicap));
}

bool is_rival_better(double lead, const HandOverOptions& options) {
  return lead > options.rival_margin;
}

Duration next_search_period(Duration last, double lead) {
  return lead > 0.0 ? kFirstWholeRoomPeriod : std::min(2 * last, kWholeRoomPeriod);
}

}  // namespace rayloc
