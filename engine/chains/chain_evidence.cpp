#include "engine/chains/chain_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/base/check.h"
#include "engine/base/highest.h"
#include "engine/base/parallel.h"

namespace rayloc {
namespace {

constexpr std::size_t kBlock = 64;  // a count of cells, chosen: worth one task and a separate sum
constexpr double kMaxEvidence = 300.0;  // [nat], per burst: keeps exp() finite
// Counts, chosen: the coarse evaluation of all cells tries kFewTurns phases per chain and keeps
// kKeptCells cells per state.
constexpr std::size_t kFewTurns = 8;
constexpr std::size_t kKeptCells = 48;  // a count, chosen

// A grid of fewer states, for the coarse evaluation.
std::vector<std::complex<float>> few_turns(const RotationGrid& grid) {
  const auto all = grid.undoing();
  const std::size_t every = std::max<std::size_t>(1, all.size() / kFewTurns);
  std::vector<std::complex<float>> few;
  for (std::size_t i = 0; i < all.size(); i += every) {
    few.push_back(all[i]);
  }
  return few;
}

struct CoarseScan {
  std::size_t turns = 0;
  std::size_t states = 1;
  std::vector<float> value;           // [cell][state]
  std::vector<std::uint8_t> windows;  // [cell]; 0: no ray reaches it
};

CoarseScan coarse_scan(const AccessPointMap& map,
                       const ObservedBurst& observed,
                       const RotationGrid& grid) {
  const auto few = few_turns(grid);
  CoarseScan scan;
  scan.turns = few.size();
  for (std::size_t chain = 1; chain < grid.chains(); ++chain) {
    scan.states *= few.size();
  }
  scan.value.resize(map.cells() * scan.states, std::numeric_limits<float>::lowest());
  scan.windows.resize(map.cells());
  parallel_for(map.cells(), kBlock, [&](std::size_t cell) {
    map.fetch(cell + 1);
    if (map.is_reachable(cell)) {
      scan.windows[cell] =
          coarse_of_turns(map.model(cell),
                          observed.array,
                          grid.chains(),
                          few,
                          std::span(scan.value).subspan(cell * scan.states, scan.states));
    }
  });
  return scan;
}

std::vector<std::uint32_t> best_cells(const CoarseScan& scan,
                                      std::size_t state,
                                      double likelihood_exponent,
                                      std::span<const double> log_weight) {
  std::vector<double> value(scan.windows.size());
  for (std::size_t cell = 0; cell < value.size(); ++cell) {
    value[cell] =
        likelihood_exponent * static_cast<double>(scan.value[cell * scan.states + state]) +
        log_weight[cell];
  }
  const std::vector<std::size_t> cells = highest(value, kKeptCells);
  return {cells.begin(), cells.end()};
}

}  // namespace

std::vector<std::size_t> TurnEvidence::cells_near(std::span<const double> phase) const {
  std::vector<std::size_t> states = {0};
  for (std::size_t chain = 1; chain < phase.size(); ++chain) {
    const auto count = static_cast<double>(turns);
    double position = phase[chain] * count / (2.0 * std::numbers::pi);
    position -= count * std::floor(position / count);
    const auto below = static_cast<std::size_t>(position) % turns;
    std::vector<std::size_t> next;
    for (const std::size_t state : states) {
      next.push_back(state * turns + below);
      next.push_back(state * turns + (below + 1) % turns);
    }
    states = std::move(next);
  }
  std::vector<std::size_t> cells;
  for (const std::size_t state : states) {
    cells.insert(cells.end(), best_cells[state].begin(), best_cells[state].end());
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

TurnEvidence turn_evidence(const AccessPointMap& map,
                           const ObservedBurst& observed,
                           const RotationGrid& grid,
                           double likelihood_exponent,
                           std::span<const double> log_weight) {
  RAYLOC_CHECK(grid.chains() == map.antennas());
  RAYLOC_CHECK(log_weight.size() == map.cells());
  const double null_model = map.null_model(observed);
  const CoarseScan scan = coarse_scan(map, observed, grid);
  TurnEvidence evidence;
  evidence.turns = scan.turns;
  evidence.best_cells.resize(scan.states);
  parallel_for(scan.states, 1, [&](std::size_t state) {
    evidence.best_cells[state] = best_cells(scan, state, likelihood_exponent, log_weight);
  });
  const std::size_t blocks = (map.cells() + kBlock - 1) / kBlock;
  // One sum per block, added in block order: the same for any number of threads.
  std::vector<double> sums(blocks * grid.size());
  parallel_for(blocks, 1, [&](std::size_t block) {
    std::vector<float> values(grid.size());
    double* sum = sums.data() + block * grid.size();
    for (std::size_t cell = block * kBlock; cell < std::min(map.cells(), (block + 1) * kBlock);
         ++cell) {
      if (scan.windows[cell] == 0) {
        continue;
      }
      log_likelihood_of_turns(map.model(cell), observed.array, scan.windows[cell], grid, values);
      const double weight = std::exp(log_weight[cell]);
      for (std::size_t s = 0; s < values.size(); ++s) {
        sum[s] += weight * std::exp(std::min(
                               likelihood_exponent * (static_cast<double>(values[s]) - null_model),
                               kMaxEvidence));
      }
    }
  });
  evidence.log_evidence.resize(grid.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    evidence.log_evidence[i % grid.size()] += sums[i];
  }
  for (double& value : evidence.log_evidence) {
    value = std::log(std::max(value, std::numeric_limits<double>::min()));
  }
  return evidence;
}

std::vector<std::vector<double>> places_for_rotations(
    const AccessPointMap& map,
    const ObservedBurst& observed,
    const RotationGrid& grid,
    double likelihood_exponent,
    std::span<const std::vector<double>> probabilities) {
  RAYLOC_CHECK(grid.chains() == map.antennas());
  for (const std::vector<double>& probability : probabilities) {
    RAYLOC_CHECK(grid.size() == probability.size());
  }
  const double null_model = map.null_model(observed);
  const CoarseScan scan = coarse_scan(map, observed, grid);
  std::vector<std::vector<double>> of_cell(probabilities.size(),
                                           std::vector<double>(map.cells(), -kMaxEvidence));
  parallel_for(map.cells(), kBlock, [&](std::size_t cell) {
    if (scan.windows[cell] == 0) {
      return;
    }
    std::vector<float> values(grid.size());
    log_likelihood_of_turns(map.model(cell), observed.array, scan.windows[cell], grid, values);
    std::vector<double> sums(probabilities.size());
    for (std::size_t s = 0; s < values.size(); ++s) {
      const double likelihood = std::exp(std::min(
          likelihood_exponent * (static_cast<double>(values[s]) - null_model), kMaxEvidence));
      for (std::size_t p = 0; p < sums.size(); ++p) {
        sums[p] += probabilities[p][s] * likelihood;
      }
    }
    for (std::size_t p = 0; p < sums.size(); ++p) {
      of_cell[p][cell] = std::log(std::max(sums[p], std::numeric_limits<double>::min()));
    }
  });
  return of_cell;
}

std::vector<double> places_for_any_rotation(const AccessPointMap& map,
                                            const ObservedBurst& observed,
                                            const RotationGrid& grid,
                                            double likelihood_exponent,
                                            const std::vector<double>& probability) {
  return places_for_rotations(map, observed, grid, likelihood_exponent, {&probability, 1}).front();
}

TurnEvidence turn_evidence_at(const PlaceModel& place,
                              const ObservedArray& observed,
                              const RotationGrid& grid,
                              double likelihood_exponent,
                              double null_model) {
  std::vector<float> values(grid.size());
  constexpr std::uint8_t kAllWindows = 0xFF;  // one bit each
  log_likelihood_of_turns(place, observed, kAllWindows, grid, values);
  TurnEvidence evidence;
  for (const float value : values) {
    evidence.log_evidence.push_back(likelihood_exponent *
                                    (static_cast<double>(value) - null_model));
  }
  return evidence;
}

}  // namespace rayloc
