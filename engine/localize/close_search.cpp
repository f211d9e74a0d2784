#include "engine/localize/close_search.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "engine/base/highest.h"
#include "engine/base/parallel.h"
#include "engine/posterior/cell_places.h"

namespace rayloc {
namespace {

// The best cells are looked at closely, place by place: those whose
// tempered log-likelihood is within this of the best.
constexpr double kRefinedMargin = 6.0;
constexpr std::size_t kMostRefined = 100;  // a count of cells, chosen: bounds the time of a fix
constexpr std::size_t kMostFine =
    25;  // no more than these: at half of the distance, it costs as much
// Of an unknown height. A cell as a whole says less of the device than its places, so more cells
// are looked at, layer by layer: those whose tempered log-likelihood is within this of the best.
constexpr double kColumnMargin = 12.0;
constexpr std::size_t kMostColumns = 400;  // a count of cells, chosen: bounds the time of a fix
constexpr double kBoxMargin = 8.0;         // the same of boxes, which are looked at place by place
constexpr std::size_t kMostBoxes = 480;    // a count, of all access points together
constexpr double kLeastWeight = 1e-4;      // of a layer that is worth a look

// Those with the highest scores, best first, none of them `margin` below the best.
std::vector<std::size_t> best_of(const std::vector<double>& score,
                                 std::size_t most,
                                 double margin) {
  std::vector<std::size_t> order = highest(score, most);
  while (score[order.back()] < score[order.front()] - margin) {
    order.pop_back();
  }
  return order;
}

// Log-likelihoods of the places of a lattice at one height, [place][array].
using Places = std::vector<std::vector<double>>;

class Searcher {
 public:
  explicit Searcher(const CloseSearch& search) : search_(search) {}

  // Access points hear a device in a layer of a cell: null where no ray arrives.
  std::vector<std::unique_ptr<const CloseLook>> look(std::size_t cell, std::size_t layer) const {
    std::vector<std::unique_ptr<const CloseLook>> looks(search_.heard.size());
    for (std::size_t i = 0; i < looks.size(); ++i) {
      const HeardArray& one = search_.heard[i];
      if (one.map->is_reachable(cell)) {
        looks[i] = one.map->look_at(cell, layer, one.observed);
      }
    }
    return looks;
  }
  // Whether the likelihood tells places apart.
  bool tells(std::size_t cell, const std::vector<std::unique_ptr<const CloseLook>>& looks) const {
    for (std::size_t i = 0; i < looks.size(); ++i) {
      if (looks[i] == nullptr && search_.heard[i].map->is_reachable(cell)) {
        return false;
      }
    }
    return true;
  }
  double above(std::size_t i, std::size_t cell, double log_likelihood) const {
    return log_likelihood - search_.nowhere[i] +
           search_.heard[i].level_at(cell, search_.likelihood_exponent);
  }
  Places on(std::size_t cell,
            const std::vector<std::unique_ptr<const CloseLook>>& looks,
            const Lattice& lattice,
            double height) const {
    Places places(lattice.size(), std::vector<double>(looks.size()));
    for (std::size_t i = 0; i < looks.size(); ++i) {
      if (looks[i] == nullptr) {
        continue;
      }
      const auto values = looks[i]->on(lattice, height);
      for (std::size_t j = 0; j < places.size(); ++j) {
        places[j][i] = above(i, cell, values[j]);
      }
    }
    return places;
  }
  std::vector<double> fused(const Places& places) const {
    std::vector<double> result;
    result.reserve(places.size());
    for (const std::vector<double>& place : places) {
      result.push_back(search_.fusion.log_likelihood(place));
    }
    return result;
  }

 private:
  const CloseSearch& search_;
};

// At the one height: cell by cell.
void search_cells(const CloseSearch& search, RoomMap& map) {
  const double exponent = search.likelihood_exponent;
  std::vector<double>& cells = map.log_likelihood;
  std::vector<double> score = cells;
  for (std::size_t i = 0; i < search.focus.log_prior.size(); ++i) {
    score[i] += search.focus.log_prior[i] / exponent;
  }
  const std::vector<std::size_t> order = best_of(score, kMostRefined, kRefinedMargin / exponent);
  const CellMoments uniform = uniform_moments(search.grid);
  for (const std::size_t cell : order) {
    map.within.push_back({cell, {uniform, uniform, 1.0, {}}});
  }
  const double finer = order.size() <= kMostFine ? 0.5 : 1.0;
  const Lattice lattice = places_of_cell(search.grid, finer * search.wavelength);
  const Searcher searcher(search);
  parallel_for(order.size(), 1, [&](std::size_t n) {
    const std::size_t cell = order[n];
    const auto looks = searcher.look(cell, 0);
    if (!searcher.tells(cell, looks)) {
      return;
    }
    const Places places = searcher.on(cell, looks, lattice, 0.0);
    const std::vector<double> fused = searcher.fused(places);
    const auto [log_mean, mass] = summarise_places(lattice, fused, exponent);
    cells[cell] = log_mean;
    map.within[n].second = mass;
    for (std::size_t i = 0; i < looks.size(); ++i) {
      double doubt = 0.0;
      for (std::size_t j = 0; j < places.size(); ++j) {
        doubt += std::exp(exponent * (fused[j] - log_mean)) * search.fusion.faulty(i, places[j][i]);
      }
      map.doubt[i][cell] = doubt / static_cast<double>(places.size());
    }
  });
}

// A cell and a layer of heights: probability masses are e^(log_mass).
struct Box {
  std::size_t cell = 0;
  std::size_t layer = 0;
  double log_mass = 0.0;      // of the box, its prior with it
  CellMass mass;              // where in it
  std::vector<double> doubt;  // [array], that it is wrong there
};

class BoxSearch {
 public:
  explicit BoxSearch(const CloseSearch& search)
      : search_(search),
        searcher_(search),
        lattice_(places_of_cell(search.grid, search.wavelength)) {
    const HeightLayers& heights = search.heights;
    weight_ = search.focus.layer_weight.empty() ? heights.weight : search.focus.layer_weight;
    for (std::size_t layer = 0; layer < heights.size(); ++layer) {
      slices_.push_back(slices_of(heights,
                                  layer,
                                  search.grid.height_sigma,
                                  NearbyLikelihood::kHeightDistance * search.wavelength));
    }
  }

  void run(RoomMap& map) const {
    const double exponent = search_.likelihood_exponent;
    std::vector<double> score(map.log_likelihood.size());
    for (std::size_t cell = 0; cell < score.size(); ++cell) {
      score[cell] = exponent * map.log_likelihood[cell] + prior(cell);
    }
    const std::vector<std::size_t> cells = best_of(score, kMostColumns, kColumnMargin);
    const std::size_t layers = weight_.size();
    std::vector<Box> boxes(cells.size() * layers);
    std::vector<double> box_score(boxes.size());
    parallel_for(boxes.size(), 4, [&](std::size_t n) {
      boxes[n] = as_a_whole(cells[n / layers], n % layers);
      box_score[n] = boxes[n].log_mass + prior(boxes[n].cell);
    });
    const std::vector<std::size_t> closely =
        best_of(box_score, std::max<std::size_t>(1, kMostBoxes / search_.heard.size()), kBoxMargin);
    parallel_for(closely.size(), 1, [&](std::size_t n) { look_closely(boxes[closely[n]]); });
    for (std::size_t n = 0; n < cells.size(); ++n) {
      put_together(std::span(boxes).subspan(n * layers, layers), map);
    }
  }

 private:
  double prior(std::size_t cell) const {
    return search_.focus.log_prior.empty() ? 0.0 : search_.focus.log_prior[cell];
  }

  Box as_a_whole(std::size_t cell, std::size_t layer) const {
    Box box;
    box.cell = cell;
    box.layer = layer;
    box.doubt.resize(search_.heard.size());
    if (weight_[layer] < kLeastWeight) {
      box.log_mass = AccessPointFusion::kNothing;
      return box;
    }
    std::vector<double> of_each(search_.heard.size());
    for (std::size_t i = 0; i < of_each.size(); ++i) {
      const HeardArray& one = search_.heard[i];
      if (one.map->is_reachable(cell)) {
        of_each[i] =
            searcher_.above(i, cell, one.map->log_likelihood_in(cell, layer, one.observed));
      }
      box.doubt[i] = search_.fusion.faulty(i, of_each[i]);
    }
    box.log_mass = std::log(weight_[layer]) +
                   search_.likelihood_exponent * search_.fusion.log_likelihood(of_each);
    box.mass.all = uniform_moments(search_.grid);
    box.mass.all.z = search_.heights.offset[layer];
    box.mass.all.zz = search_.heights.thickness * search_.heights.thickness / 12.0;
    box.mass.best = box.mass.all;
    return box;
  }

  void look_closely(Box& box) const {
    const auto looks = searcher_.look(box.cell, box.layer);
    if (!searcher_.tells(box.cell, looks)) {
      return;
    }
    const double exponent = search_.likelihood_exponent;
    std::vector<PlacesAtHeight> at_heights;
    std::vector<Places> places;
    for (const HeightSlice& slice : slices_[box.layer]) {
      const double above = slice.offset - search_.heights.offset[box.layer];
      places.push_back(searcher_.on(box.cell, looks, lattice_, above));
      PlacesAtHeight& at = at_heights.emplace_back();
      at.height = slice.offset;
      at.log_mass = searcher_.fused(places.back());
      for (double& one : at.log_mass) {
        one = exponent * one + std::log(slice.weight / static_cast<double>(lattice_.size()));
      }
    }
    auto [log_sum, mass] = summarise_box(lattice_, at_heights);
    box.log_mass = std::log(weight_[box.layer]) + log_sum;
    box.mass = mass;
    std::fill(box.doubt.begin(), box.doubt.end(), 0.0);
    for (std::size_t h = 0; h < places.size(); ++h) {
      for (std::size_t j = 0; j < places[h].size(); ++j) {
        const double share = std::exp(at_heights[h].log_mass[j] - log_sum);
        for (std::size_t i = 0; i < looks.size(); ++i) {
          box.doubt[i] += share * search_.fusion.faulty(i, places[h][j][i]);
        }
      }
    }
  }

  void put_together(std::span<const Box> boxes, RoomMap& map) const {
    const std::size_t cell = boxes.front().cell;
    const auto best = std::max_element(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) {
      return a.log_mass + std::log(a.mass.best_share) < b.log_mass + std::log(b.mass.best_share);
    });
    double sum = 0.0;
    for (const Box& box : boxes) {
      sum += std::exp(box.log_mass - best->log_mass);
    }
    CellMass mass;
    std::vector<WeightedMoments> parts;
    for (const Box& box : boxes) {
      const double share = std::exp(box.log_mass - best->log_mass) / sum;
      parts.push_back({share, box.mass.all});
      mass.layers.push_back(static_cast<float>(share));
    }
    mass.all = mixture_of(parts);
    mass.best = best->mass.best;
    mass.best_share = best->mass.best_share / sum;
    for (std::size_t i = 0; i < map.doubt.size(); ++i) {
      double doubt = 0.0;
      for (std::size_t layer = 0; layer < boxes.size(); ++layer) {
        doubt += parts[layer].share * boxes[layer].doubt[i];
      }
      map.doubt[i][cell] = doubt;
    }
    map.log_likelihood[cell] = (best->log_mass + std::log(sum)) / search_.likelihood_exponent;
    map.within.emplace_back(cell, std::move(mass));
  }

  const CloseSearch& search_;
  Searcher searcher_;
  Lattice lattice_;
  std::vector<double> weight_;                    // [layer]
  std::vector<std::vector<HeightSlice>> slices_;  // [layer]
};

}  // namespace

void search_closely(const CloseSearch& search, RoomMap& map) {
  if (search.heights.is_known()) {
    search_cells(search, map);
  } else {
    BoxSearch(search).run(map);
  }
}

}  // namespace rayloc
