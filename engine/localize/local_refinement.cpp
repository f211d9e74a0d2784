#include "engine/localize/local_refinement.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/highest.h"
#include "engine/base/parallel.h"
#include "engine/grid/cell_mass.h"
#include "engine/grid/height_layers.h"
#include "engine/grid/lattice.h"
#include "engine/posterior/cell_places.h"

namespace rayloc {
namespace {

// The best cells are refined place by place: those whose tempered log-likelihood is within this
// margin of the best.
constexpr double kRefinedMargin = 6.0;
constexpr std::size_t kMaxRefined = 100;  // a count of cells, chosen: bounds the time of a fix
constexpr std::size_t kMaxFine = 25;  // at most this many at half the distance, which costs as much
// For an unknown height. A whole cell is less informative than its places, so more cells are
// evaluated, layer by layer: those whose tempered log-likelihood is within this of the best.
constexpr double kColumnMargin = 12.0;
constexpr std::size_t kMaxCloseColumns = 400;  // a count of cells, chosen: bounds the time of a fix
constexpr double kBoxMargin = 8.0;             // the same for boxes that are refined place by place
constexpr std::size_t kMaxCloseBoxes = 480;    // a count, of all access points together
constexpr double kMinWeight = 1e-4;            // least weight of an evaluated layer

// The entries with the highest scores, best first, at most `margin` below the best.
std::vector<std::size_t> best_of(const std::vector<double>& score,
                                 std::size_t most,
                                 double margin) {
  std::vector<std::size_t> order = highest(score, most);
  while (score[order.back()] < score[order.front()] - margin) {
    order.pop_back();
  }
  return order;
}

using Evaluators = std::vector<std::unique_ptr<const BoxEvaluator>>;

// Log-likelihoods of places, [place][array].
struct Places {
  std::size_t arrays = 0;
  std::vector<double> value;

  std::size_t size() const { return value.size() / arrays; }
  std::span<const double> of(std::size_t place) const {
    return std::span(value).subspan(place * arrays, arrays);
  }
};

class Searcher {
 public:
  explicit Searcher(const LocalRefinement& search) : search_(search) {}

  // Models of each access point for a device in a layer of a cell: null if no ray arrives.
  Evaluators evaluators_of(std::size_t cell, std::size_t layer) const {
    Evaluators evaluators(search_.received.size());
    for (std::size_t i = 0; i < evaluators.size(); ++i) {
      const ArrayObservation& one = search_.received[i];
      if (one.map->is_reachable(cell)) {
        evaluators[i] = one.map->evaluator_at(cell, layer, one.observed);
      }
    }
    return evaluators;
  }
  // True if the likelihood separates the places of the cell.
  bool separates(std::size_t cell, const Evaluators& evaluators) const {
    for (std::size_t i = 0; i < evaluators.size(); ++i) {
      if (evaluators[i] == nullptr && search_.received[i].map->is_reachable(cell)) {
        return false;
      }
    }
    return true;
  }
  double above(std::size_t i, std::size_t cell, double log_likelihood) const {
    return log_likelihood - search_.null_model[i] +
           search_.received[i].power_log_likelihood_at(cell, search_.likelihood_exponent);
  }
  // Log-likelihoods at the places of a lattice at each of the heights.
  Places on(std::size_t cell,
            const Evaluators& evaluators,
            const Lattice& lattice,
            const BoxEvaluator::Heights& heights) const {
    Places places{evaluators.size(), {}};
    places.value.resize(heights.count * lattice.size() * evaluators.size());
    for (std::size_t i = 0; i < evaluators.size(); ++i) {
      if (evaluators[i] == nullptr) {
        continue;
      }
      const auto values = evaluators[i]->on(lattice, heights);
      for (std::size_t j = 0; j < values.size(); ++j) {
        places.value[j * evaluators.size() + i] = above(i, cell, values[j]);
      }
    }
    return places;
  }
  std::vector<double> fused(const Places& places) const {
    std::vector<double> result(places.size());
    for (std::size_t j = 0; j < result.size(); ++j) {
      result[j] = search_.fusion.log_likelihood(places.of(j));
    }
    return result;
  }

 private:
  const LocalRefinement& search_;
};

// Scores of the cells that may be refined.
std::vector<double> scores(const LocalRefinement& search, const RoomMap& map, double exponent) {
  const auto close = static_cast<std::ptrdiff_t>(search.compared.ones(search.grid));
  std::vector<double> score(map.log_likelihood.begin(), map.log_likelihood.begin() + close);
  for (double& one : score) {
    one *= exponent;
  }
  for (std::size_t n = 0; n < search.focus.log_prior.size(); ++n) {
    score[n] += search.focus.log_prior[n];
  }
  return score;
}

// Search at a single height: cell by cell.
void search_cells(const LocalRefinement& search, RoomMap& map) {
  const double exponent = search.likelihood_exponent;
  std::vector<double>& values = map.log_likelihood;
  const std::vector<std::size_t> order =
      best_of(scores(search, map, exponent), kMaxRefined, kRefinedMargin);
  const CellMoments uniform = uniform_moments(search.grid);
  for (const std::size_t n : order) {
    map.within.push_back({search.compared.cell(n), {uniform, uniform, 1.0, {}}});
  }
  const double finer = order.size() <= kMaxFine ? 0.5 : 1.0;
  const Lattice lattice = places_of_cell(search.grid, finer * search.wavelength);
  const Searcher searcher(search);
  parallel_for(order.size(), 1, [&](std::size_t rank) {
    const std::size_t n = order[rank];
    const std::size_t cell = search.compared.cell(n);
    const auto evaluators = searcher.evaluators_of(cell, 0);
    if (!searcher.separates(cell, evaluators)) {
      return;
    }
    const Places places = searcher.on(cell, evaluators, lattice, {});
    const std::vector<double> fused = searcher.fused(places);
    const auto [log_mean, mass] = summarise_places(lattice, fused, exponent);
    values[n] = log_mean;
    map.within[rank].second = mass;
    for (std::size_t i = 0; i < evaluators.size(); ++i) {
      double fault_probability = 0.0;
      for (std::size_t j = 0; j < places.size(); ++j) {
        fault_probability +=
            std::exp(exponent * (fused[j] - log_mean)) * search.fusion.faulty(i, places.of(j)[i]);
      }
      map.fault_probability[i][n] = fault_probability / static_cast<double>(places.size());
    }
  });
}

// A cell and a layer of heights: probability masses are e^(log_mass).
struct RefinedBox {
  std::size_t number = 0;  // of the cell, in the map
  std::size_t cell = 0;
  std::size_t layer = 0;
  double log_mass = 0.0;                  // of the box, including its prior
  CellMass mass;                          // distribution inside the box
  std::vector<double> fault_probability;  // [array], probability that it is wrong there
};

class BoxSearch {
 public:
  explicit BoxSearch(const LocalRefinement& search)
      : search_(search),
        searcher_(search),
        lattice_(places_of_cell(search.grid, search.wavelength)) {
    const HeightLayers& heights = search.grid.layers;
    weight_ = search.focus.layer_weight.empty() ? heights.weight : search.focus.layer_weight;
    for (std::size_t layer = 0; layer < heights.size(); ++layer) {
      slices_.push_back(slices_of(heights,
                                  layer,
                                  search.grid.height_sigma,
                                  NearbyLikelihood::kHeightDistance * search.wavelength));
    }
  }

  void run(RoomMap& map) const {
    const std::vector<std::size_t> cells =
        best_of(scores(search_, map, search_.likelihood_exponent), kMaxCloseColumns, kColumnMargin);
    const std::size_t layers = weight_.size();
    std::vector<RefinedBox> boxes(cells.size() * layers);
    std::vector<double> box_score(boxes.size());
    parallel_for(boxes.size(), 4, [&](std::size_t n) {
      boxes[n] = as_a_whole(cells[n / layers], n % layers);
      box_score[n] = boxes[n].log_mass + prior(boxes[n].number);
    });
    const std::vector<std::size_t> closely = best_of(
        box_score, std::max<std::size_t>(1, kMaxCloseBoxes / search_.received.size()), kBoxMargin);
    parallel_for(closely.size(), 1, [&](std::size_t n) { refine(boxes[closely[n]]); });
    for (std::size_t n = 0; n < cells.size(); ++n) {
      put_together(std::span(boxes).subspan(n * layers, layers), map);
    }
  }

 private:
  double prior(std::size_t number) const {
    return search_.focus.log_prior.empty() ? 0.0 : search_.focus.log_prior[number];
  }

  RefinedBox as_a_whole(std::size_t number, std::size_t layer) const {
    const std::size_t cell = search_.compared.cell(number);
    RefinedBox box;
    box.number = number;
    box.cell = cell;
    box.layer = layer;
    box.fault_probability.resize(search_.received.size());
    if (weight_[layer] < kMinWeight) {
      box.log_mass = AccessPointFusion::kNothing;
      return box;
    }
    std::vector<double> of_each(search_.received.size());
    for (std::size_t i = 0; i < of_each.size(); ++i) {
      const ArrayObservation& one = search_.received[i];
      if (one.map->is_reachable(cell)) {
        of_each[i] =
            searcher_.above(i, cell, one.map->log_likelihood_in(cell, layer, one.observed));
      }
      box.fault_probability[i] = search_.fusion.faulty(i, of_each[i]);
    }
    box.log_mass = std::log(weight_[layer]) +
                   search_.likelihood_exponent * search_.fusion.log_likelihood(of_each);
    box.mass.all = uniform_moments(search_.grid);
    box.mass.all.z = search_.grid.layers.offset[layer];
    box.mass.all.zz = search_.grid.layers.thickness * search_.grid.layers.thickness / 12.0;
    box.mass.best = box.mass.all;
    return box;
  }

  void refine(RefinedBox& box) const {
    const auto evaluators = searcher_.evaluators_of(box.cell, box.layer);
    if (!searcher_.separates(box.cell, evaluators)) {
      return;
    }
    const double exponent = search_.likelihood_exponent;
    const std::vector<HeightSlice>& slices = slices_[box.layer];
    const double step = slices.size() > 1 ? (slices.back().offset - slices.front().offset) /
                                                static_cast<double>(slices.size() - 1)
                                          : 0.0;
    const double lowest = slices.front().offset - search_.grid.layers.offset[box.layer];
    const Places places =
        searcher_.on(box.cell, evaluators, lattice_, {lowest, step, slices.size()});
    const std::vector<double> fused = searcher_.fused(places);
    std::vector<PlacesAtHeight> at_heights;
    for (std::size_t h = 0; h < slices.size(); ++h) {
      const auto begin = fused.begin() + static_cast<std::ptrdiff_t>(h * lattice_.size());
      PlacesAtHeight& at = at_heights.emplace_back();
      at.height = slices[h].offset;
      at.log_mass.assign(begin, begin + static_cast<std::ptrdiff_t>(lattice_.size()));
      const double share = std::log(slices[h].weight / static_cast<double>(lattice_.size()));
      for (double& one : at.log_mass) {
        one = exponent * one + share;
      }
    }
    auto [log_sum, mass] = summarise_box(lattice_, at_heights);
    box.log_mass = std::log(weight_[box.layer]) + log_sum;
    box.mass = mass;
    std::fill(box.fault_probability.begin(), box.fault_probability.end(), 0.0);
    for (std::size_t j = 0; j < places.size(); ++j) {
      const double share =
          std::exp(at_heights[j / lattice_.size()].log_mass[j % lattice_.size()] - log_sum);
      for (std::size_t i = 0; i < evaluators.size(); ++i) {
        box.fault_probability[i] += share * search_.fusion.faulty(i, places.of(j)[i]);
      }
    }
  }

  void put_together(std::span<const RefinedBox> boxes, RoomMap& map) const {
    const std::size_t number = boxes.front().number;
    const auto best =
        std::max_element(boxes.begin(), boxes.end(), [](const RefinedBox& a, const RefinedBox& b) {
          return a.log_mass + std::log(a.mass.best_share) <
                 b.log_mass + std::log(b.mass.best_share);
        });
    double sum = 0.0;
    for (const RefinedBox& box : boxes) {
      sum += std::exp(box.log_mass - best->log_mass);
    }
    CellMass mass;
    std::vector<WeightedMoments> parts;
    for (const RefinedBox& box : boxes) {
      const double share = std::exp(box.log_mass - best->log_mass) / sum;
      parts.push_back({share, box.mass.all});
      mass.layers.push_back(static_cast<float>(share));
    }
    mass.all = mixture_of(parts);
    mass.best = best->mass.best;
    mass.best_share = best->mass.best_share / sum;
    for (std::size_t i = 0; i < map.fault_probability.size(); ++i) {
      double fault_probability = 0.0;
      for (std::size_t layer = 0; layer < boxes.size(); ++layer) {
        fault_probability += parts[layer].share * boxes[layer].fault_probability[i];
      }
      map.fault_probability[i][number] = fault_probability;
    }
    map.log_likelihood[number] = (best->log_mass + std::log(sum)) / search_.likelihood_exponent;
    map.within.emplace_back(boxes.front().cell, std::move(mass));
  }

  const LocalRefinement& search_;
  Searcher searcher_;
  Lattice lattice_;
  std::vector<double> weight_;                    // [layer]
  std::vector<std::vector<HeightSlice>> slices_;  // [layer]
};

}  // namespace

CellSet compared_cells(const Grid& grid, const SearchFocus& focus) {
  if (focus.cells.empty()) {
    return {};
  }
  RAYLOC_CHECK(!focus.others.empty() && focus.cells.size() < grid.size());
  return CellSet::with_sample(focus.cells, focus.others, grid.size());
}

void refine_locally(const LocalRefinement& search, RoomMap& map) {
  if (search.grid.layers.is_known()) {
    search_cells(search, map);
  } else {
    BoxSearch(search).run(map);
  }
}

}  // namespace rayloc
