#include "engine/chains/coarse_fix.h"

#include <algorithm>
#include <cmath>
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
// A probability, chosen: the belief in the states is wrong. It does not depend on the frames: wrong
// states explain one burst at a wrong place about as well as the right ones at the right place.
constexpr double kBeliefWrong = 0.5;
// Share of the area, chosen: with more the frames contain no information on the place. A region of
// most of the room is reported: it is correct, and its accuracy states its size.
constexpr double kMaxSpread = 0.95;

// [cell]: ln of the probability of each cell; the probabilities sum to 1.
std::vector<double> normalised(const std::vector<double>& log_likelihood) {
  CellBelief belief(log_likelihood.size());
  belief.receive(log_likelihood, 0.0);
  return belief.log_probability();
}

// Share of the cells that are inside the area.
double inside_of(const SearchArea& area) {
  return area.inside.empty()
             ? 1.0
             : static_cast<double>(std::count(area.inside.begin(), area.inside.end(), 1)) /
                   static_cast<double>(area.inside.size());
}

// [cell]: the access point's evidence on the place, received power included. `belief`: of all of
// its chains.
std::vector<double> cells_of(const ArrayObservation& received,
                             double likelihood_exponent,
                             std::span<const double> belief) {
  const RotationGrid grid(received.map->antennas());
  std::vector<std::vector<double>> states = {
      std::vector<double>(grid.size(), 1.0 / static_cast<double>(grid.size()))};
  if (belief.size() == grid.size()) {
    states.emplace_back(belief.begin(), belief.end());
  }
  std::vector<std::vector<double>> maps =
      places_for_rotations(*received.map, received.observed, grid, likelihood_exponent, states);
  for (std::vector<double>& cells : maps) {
    for (std::size_t cell = 0; cell < cells.size() && !received.power_log_likelihood.empty();
         ++cell) {
      cells[cell] += received.power_log_likelihood[cell];
    }
  }
  if (maps.size() == 1) {
    return maps.front();
  }
  std::vector<double> any = normalised(maps[0]);
  const std::vector<double> by_belief = normalised(maps[1]);
  for (std::size_t cell = 0; cell < any.size(); ++cell) {
    any[cell] = std::log(kBeliefWrong * std::exp(any[cell]) +
                         (1.0 - kBeliefWrong) * std::exp(by_belief[cell]));
  }
  return any;
}

}  // namespace

LocationEstimate locate_coarsely(const Localizer& localizer,
                                 std::span<const CsiFrame> frames,
                                 std::span<const std::vector<double>> beliefs) {
  RoomObservation observation = localizer.receive(frames);
  LocationEstimate& estimate = observation.estimate;
  const RoomModel& room = localizer.room();
  CellBelief belief(localizer.grid().size());
  bool is_received = false;
  for (const ArrayObservation& received : observation.arrays) {
    if (received.map->antennas() <= kMaxChains) {
      const std::size_t a = received.map->number();
      const auto of_states =
          a < beliefs.size() ? std::span<const double>(beliefs[a]) : std::span<const double>();
      belief.receive(cells_of(received, room.likelihood_exponent, of_states), kWrong);
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
                       .sigma_floor = room.sigma_floor,
                       .max_spread = kMaxSpread * inside_of(localizer.area())},
                      estimate);
  return std::move(estimate);
}

}  // namespace rayloc
