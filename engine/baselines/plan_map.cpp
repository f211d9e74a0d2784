#include "engine/baselines/plan_map.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/grid/grid.h"
#include "engine/posterior/posterior.h"

namespace rayloc {
namespace {

constexpr double kMaxCells = 12000.0;   // of a room, approximate count: as many as RayLoc's own map
constexpr std::size_t kMapGrain = 256;  // cells per task, a count

}  // namespace

void summarise_plan(const RoomModel& room,
                    const PlanMapOptions& options,
                    const std::function<double(const Vec3d& place)>& log_likelihood,
                    LocationEstimate& estimate) {
  Grid grid(room.bounds_min,
            room.bounds_max,
            room.device.height,
            std::max(options.step, std::sqrt(room.area() / kMaxCells)));
  grid.height_sigma = room.device.height_sigma;
  std::vector<double> map(grid.size());
  parallel_for(grid.size(), kMapGrain, [&](std::size_t cell) {
    map[cell] = log_likelihood(grid.centre(cell));
  });
  estimate.loss = -*std::max_element(map.begin(), map.end());
  PosteriorOptions posterior;
  posterior.accuracy_confidence = options.accuracy_confidence;
  posterior.outlier = options.outlier;
  posterior.sigma_floor = room.sigma_floor;
  summarise_posterior(grid, map, posterior, estimate);
}

}  // namespace rayloc
