#include "engine/chains/coarse_fix.h"

#include <utility>
#include <vector>

#include "engine/chains/cell_belief.h"
#include "engine/chains/chain_evidence.h"
#include "engine/likelihood/chain_kernel.h"
#include "engine/localize/search_area.h"
#include "engine/posterior/posterior.h"

namespace rayloc {
namespace {

// Above those of FaultPrior: no phase is available here to contradict a wrong access point.
constexpr double kWrong = 0.1;  // a probability, chosen: an access point has no position evidence
constexpr double kOutlier = 0.03;  // a probability, chosen: none of them has any

// [cell]: the access point's evidence on the place, received power included.
std::vector<double> cells_of(const ArrayObservation& received, double likelihood_exponent) {
  const RotationGrid grid(received.map->antennas());
  const std::vector<double> any(grid.size(), 1.0 / static_cast<double>(grid.size()));
  std::vector<double> cells =
      places_for_any_rotation(*received.map, received.observed, grid, likelihood_exponent, any);
  for (std::size_t cell = 0; cell < cells.size() && !received.power_log_likelihood.empty();
       ++cell) {
    cells[cell] += received.power_log_likelihood[cell];
  }
  return cells;
}

}  // namespace

LocationEstimate locate_coarsely(const Localizer& localizer, std::span<const CsiFrame> frames) {
  RoomObservation observation = localizer.receive(frames);
  LocationEstimate& estimate = observation.estimate;
  const RoomModel& room = localizer.room();
  CellBelief belief(localizer.grid().size());
  bool is_received = false;
  for (const ArrayObservation& received : observation.arrays) {
    if (received.map->antennas() <= kMaxChains) {
      belief.receive(cells_of(received, room.likelihood_exponent), kWrong);
      is_received = true;
    }
  }
  if (!is_received) {
    return std::move(estimate);
  }
  estimate.reason.clear();
  std::vector<double> log_probability = belief.log_probability();
  const double outside = take_outside(localizer.area(), 1.0, log_probability);
  if (outside > SearchArea::kMaxOutlierShare) {
    estimate.reason = SearchArea::kBeside;
    return std::move(estimate);
  }
  summarise_posterior(localizer.grid(),
                      log_probability,
                      {.accuracy_confidence = localizer.options().accuracy_confidence,
                       .max_hypotheses = localizer.options().max_hypotheses,
                       .outlier = 1.0 - (1.0 - kOutlier) * (1.0 - outside),
                       .sigma_floor = room.sigma_floor},
                      estimate);
  return std::move(estimate);
}

}  // namespace rayloc
