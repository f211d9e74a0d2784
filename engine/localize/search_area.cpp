#include "engine/localize/search_area.h"

#include <algorithm>
#include <cmath>

#include "engine/posterior/access_point_fusion.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

// About this many cells per room: 5 cm in a small room, larger cells in a large one.
constexpr double kCells = 12000.0;
constexpr double kFinestStep = 0.05;  // [m]
constexpr double kMaxMargin = 2.0;    // [m]
constexpr double kMinMargin = 0.5;    // [m], less is the thickness of a wall

std::size_t cells_beside(double reach, double step) {
  return reach < kMinMargin
             ? 0
             : static_cast<std::size_t>(std::ceil(std::min(reach, kMaxMargin) / step));
}

}  // namespace

SearchArea search_area(const RoomModel& room) {
  const Vec3d& low = room.bounds_min;
  const Vec3d& high = room.bounds_max;
  const double step =
      std::max(kFinestStep, std::sqrt((high.x - low.x) * (high.y - low.y) / kCells));
  SearchArea area{{low, high, room.device.height, step}, {}};
  area.grid.height_sigma = room.device.height_sigma;
  Grid& grid = area.grid;
  const Grid inner = grid;
  const Vec3d& reach_low = room.scene->bounds_min();
  const Vec3d& reach_high = room.scene->bounds_max();
  const std::size_t west = cells_beside(low.x - reach_low.x, grid.step_x);
  const std::size_t east = cells_beside(reach_high.x - high.x, grid.step_x);
  const std::size_t south = cells_beside(low.y - reach_low.y, grid.step_y);
  const std::size_t north = cells_beside(reach_high.y - high.y, grid.step_y);
  if (west + east + south + north == 0) {
    return area;
  }
  grid.first =
      grid.first -
      Vec3d{static_cast<double>(west) * grid.step_x, static_cast<double>(south) * grid.step_y, 0.0};
  grid.count_x += west + east;
  grid.count_y += south + north;
  area.inside.resize(grid.size());
  for (std::size_t x = 0; x < inner.count_x; ++x) {
    for (std::size_t y = 0; y < inner.count_y; ++y) {
      area.inside[(x + west) * grid.count_y + y + south] = 1;
    }
  }
  return area;
}

double take_outside(const SearchArea& area,
                    double likelihood_exponent,
                    std::vector<double>& log_likelihood,
                    const CellSet& cells) {
  if (area.inside.empty()) {
    return 0.0;
  }
  const double top = *std::max_element(log_likelihood.begin(), log_likelihood.end());
  double all = 0.0;
  double outside = 0.0;
  for (std::size_t i = 0; i < log_likelihood.size(); ++i) {
    const double mass =
        cells.weights.of(i) * std::exp(likelihood_exponent * (log_likelihood[i] - top));
    all += mass;
    if (area.inside[cells.cell(i)] == 0) {
      outside += mass;
      log_likelihood[i] = AccessPointFusion::kNothing;
    }
  }
  return outside / all;
}

}  // namespace rayloc
