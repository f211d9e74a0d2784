#include "engine/localize/tracked_search.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/highest.h"
#include "engine/base/parallel.h"
#include "engine/posterior/cell_places.h"
#include "engine/posterior/place_fusion.h"

namespace rayloc {
namespace {

// Share of the prior mass, chosen. With 5e-3 a peak of half a per cent was given up, and 20 of 579
// moments of a walk lost the place that ranks first in the whole room (hundred-devices study).
constexpr double kUnevaluated = 1e-3;
// A count of boxes, chosen: over all access points. 90 % of the mass of a track with one access
// point lies in 30 to 280 boxes (hundred-devices study).
constexpr std::size_t kMaxTrackedBoxes = 640;
// Share of the mass, chosen: with more outside its own share of boxes, an access point also uses
// those of the others. An uncertain position has many peaks, and none of them may be given up.
constexpr double kWide = 0.02;
constexpr std::size_t kMaxDenseBoxes =
    96;                               // a count, chosen: of kMaxTrackedBoxes, with all their places
constexpr double kCloseMargin = 8.0;  // [nat], below the best
constexpr std::size_t kFewX = 2;      // a count: every second place in x ...
constexpr std::size_t kFewZ = 4;      // a count: ... and every fourth in height is evaluated first
// A count of cells, and their margin below the best of a room, both as in the local refinement.
constexpr std::size_t kMaxTrackedColumns = 400;
constexpr double kTrackedColumnMargin = 12.0;  // [nat], as in the local refinement
constexpr double kMinSum = 1e-37;              // least sum of a mass in single precision

}  // namespace

TrackedSearch::TrackedSearch(const Room& room,
                             std::vector<ArrayObservation> received,
                             const SearchFocus& focus)
    : room_(room),
      received_(std::move(received)),
      layer_weight_(focus.layer_weight.empty() ? room.grid.layers.weight : focus.layer_weight),
      lattice_(places_of_box(room.grid, room.wavelength)) {
  RAYLOC_CHECK(!received_.empty() && !focus.cells.empty());
  for (std::size_t layer = 0; layer < layer_weight_.size(); ++layer) {
    slices_.push_back(slices_of_box(room.grid, layer, room.wavelength));
  }
  choose_boxes(focus);
  choose_rows();
}

// Selects the boxes with most of the prior mass.
void TrackedSearch::choose_boxes(const SearchFocus& focus) {
  const std::size_t layers = layer_weight_.size();
  std::vector<double> prior;
  prior.reserve(focus.cells.size() * layers);
  for (std::size_t n = 0; n < focus.cells.size(); ++n) {
    const double of_cell = focus.log_prior.empty() ? 1.0 : std::exp(focus.log_prior[n]);
    for (const double weight : layer_weight_) {
      prior.push_back(of_cell * weight);
    }
  }
  const double sum = std::accumulate(prior.begin(), prior.end(), 0.0);
  std::vector<std::size_t> order = highest(prior, kMaxTrackedBoxes);
  const std::size_t share = kMaxTrackedBoxes / received_.size();
  double left = sum;
  std::size_t kept = 0;
  while (kept < order.size() && left > (kept < share ? kUnevaluated : kWide) * sum) {
    left -= prior[order[kept++]];
  }
  most_closely_ =
      std::max<std::size_t>(1, kMaxDenseBoxes * std::max(share, kept) / kMaxTrackedBoxes);
  order.resize(kept);
  unevaluated_mass_ = left / sum;
  std::sort(order.begin(), order.end());
  for (const std::size_t i : order) {
    const std::size_t cell = focus.cells[i / layers];
    if (cells_.empty() || cells_.back() != cell) {
      cells_.push_back(cell);
      first_.push_back(boxes_.size());
    }
    boxes_.push_back({cells_.size() - 1, i % layers, prior[i] / sum});
  }
  first_.push_back(boxes_.size());
}

// The places evaluated first form a chessboard pattern.
void TrackedSearch::choose_rows() {
  const std::size_t rows_y = lattice_.plan.count_y / kLaneCount;
  for (std::size_t z = 0; z < lattice_.heights.size(); ++z) {
    for (std::size_t x = 0; x < lattice_.plan.count_x; ++x) {
      const bool is_first = (x + 1) % kFewX == 0 && (z + 3 + x) % kFewZ == 0;
      for (std::size_t y = 0; y < rows_y; ++y) {
        all_.push_back({x, y, z});
        if (is_first) {
          few_.push_back({x, y, z});
        }
      }
    }
  }
  if (few_.empty()) {
    few_ = all_;
  }
}

double TrackedSearch::above(std::size_t array, std::size_t cell, double null_model) const {
  return received_[array].power_log_likelihood_at(cell, room_.likelihood_exponent) - null_model;
}

// Evaluates the boxes of one cell: groups of a few layers share their covariance.
void TrackedSearch::evaluate_cell(std::size_t array,
                                  std::size_t first,
                                  std::size_t last,
                                  double null_model) {
  const ArrayObservation& received = received_[array];
  const std::size_t cell = cells_[boxes_[first].number];
  const auto add = static_cast<float>(above(array, cell, null_model));
  std::vector<LaneRow>& values = of_few_[array];
  if (!received.map->is_reachable(cell)) {
    LaneRow nothing;
    nothing.fill(add + static_cast<float>(null_model));
    std::fill(values.begin() + static_cast<std::ptrdiff_t>(first * few_.size()),
              values.begin() + static_cast<std::ptrdiff_t>(last * few_.size()),
              nothing);
    return;
  }
  std::vector<FieldRow> rows(few_.size());
  FieldScan scan(*received.map, cell, received.observed);
  for (std::size_t n = first; n < last; ++n) {
    const auto [terms, field] = scan.at(boxes_[n].layer);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      rows[r] = field->row(few_[r].x, few_[r].y, few_[r].z);
    }
    const std::span<LaneRow> out(values.data() + n * few_.size(), few_.size());
    field_rows(terms, terms.delays, rows, out);
    for (LaneRow& row : out) {
      for (float& value : row) {
        value += add;
      }
    }
  }
}

std::vector<std::vector<double>> TrackedSearch::scan(std::span<const double> null_model) {
  null_model_.assign(null_model.begin(), null_model.end());
  std::vector<std::vector<double>> maps(received_.size(), std::vector<double>(cells_.size()));
  of_few_.assign(received_.size(), std::vector<LaneRow>(boxes_.size() * few_.size()));
  parallel_for(cells_.size() * received_.size(), 1, [&](std::size_t i) {
    const std::size_t array = i / cells_.size();
    const std::size_t n = i % cells_.size();
    evaluate_cell(array, first_[n], first_[n + 1], null_model_[array]);
  });
  const auto t = static_cast<float>(room_.likelihood_exponent);
  for (std::size_t array = 0; array < received_.size(); ++array) {
    float top = of_few_[array].front()[0];
    for (const LaneRow& row : of_few_[array]) {
      top = std::max(top, *std::max_element(row.begin(), row.end()));
    }
    highest_.push_back(top);
    parallel_for(cells_.size(), 16, [&](std::size_t n) {
      std::vector<LaneRow> mass(few_.size());
      double sum = 0.0;
      double weights = 0.0;
      for (std::size_t b = first_[n]; b < first_[n + 1]; ++b) {
        const std::span<const LaneRow> values(of_few_[array].data() + b * few_.size(), few_.size());
        const FusedArray alone{values, t, t * top};
        fuse_rows({&alone, 1}, mass);
        const double weight = layer_weight_[boxes_[b].layer];
        sum += weight * mean_of(boxes_[b].layer, few_, mass);
        weights += weight;
      }
      maps[array][n] = static_cast<double>(top) +
                       std::log(std::max(sum / weights, kMinSum)) / room_.likelihood_exponent;
    });
  }
  return maps;
}

void TrackedSearch::leave_out(std::size_t array) {
  const auto at = static_cast<std::ptrdiff_t>(array);
  received_.erase(received_.begin() + at);
  null_model_.erase(null_model_.begin() + at);
  of_few_.erase(of_few_.begin() + at);
  highest_.erase(highest_.begin() + at);
}

// Mean over the places of a layer, weighted by the probability of their heights.
double TrackedSearch::mean_of(std::size_t layer,
                              std::span<const Row> rows,
                              std::span<const LaneRow> mass) const {
  double sum = 0.0;
  double weights = 0.0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    float of_row = 0.0F;
    for (const float one : mass[r]) {
      of_row += one;
    }
    const double weight = slices_[layer][rows[r].z].weight;
    sum += weight * static_cast<double>(of_row);
    weights += weight * static_cast<double>(kLaneCount);
  }
  return sum / weights;
}

TrackedSearch::Mass TrackedSearch::uniform(const Box& box, double sum) const {
  Mass mass;
  mass.sum = sum;
  mass.where.all = uniform_moments(room_.grid);
  if (!room_.grid.layers.is_known()) {
    mass.where.all.z = room_.grid.layers.offset[box.layer];
    mass.where.all.zz = room_.grid.layers.thickness * room_.grid.layers.thickness / 12.0;
  }
  mass.where.best = mass.where.all;
  return mass;
}

// Masses of all places of a box, [height][x][y].
std::vector<LaneRow> TrackedSearch::all_places(const Box& box,
                                               const std::vector<FusedArray>& fused) const {
  const std::size_t cell = cells_[box.number];
  std::vector<std::vector<LaneRow>> values(received_.size(), std::vector<LaneRow>(all_.size()));
  std::vector<FusedArray> arrays = fused;
  std::vector<FieldRow> rows(all_.size());
  for (std::size_t i = 0; i < received_.size(); ++i) {
    const auto add = static_cast<float>(above(i, cell, null_model_[i]));
    if (received_[i].map->is_reachable(cell)) {
      FieldScan scan(*received_[i].map, cell, received_[i].observed);
      const auto [terms, field] = scan.at(box.layer);
      for (std::size_t r = 0; r < rows.size(); ++r) {
        rows[r] = field->row(all_[r].x, all_[r].y, all_[r].z);
      }
      field_rows(terms, terms.delays, rows, values[i]);
    } else {
      LaneRow nothing;
      nothing.fill(static_cast<float>(null_model_[i]));
      std::fill(values[i].begin(), values[i].end(), nothing);
    }
    arrays[i].log_likelihood = values[i];
    arrays[i].shift -= arrays[i].exponent * add;
  }
  std::vector<LaneRow> mass(all_.size());
  fuse_rows(arrays, mass);
  for (std::size_t r = 0; r < mass.size(); ++r) {
    const auto weight = static_cast<float>(slices_[box.layer][all_[r].z].weight);
    for (float& one : mass[r]) {
      one *= weight;
    }
  }
  return mass;
}

void TrackedSearch::put_together(const AccessPointFusion& fusion, RoomMap& map) const {
  const std::vector<FusedArray> arrays = fused_arrays(fusion, room_.likelihood_exponent, highest_);
  double log_scale = 0.0;
  for (const FusedArray& one : arrays) {
    log_scale += static_cast<double>(one.shift);
  }
  std::vector<Mass> masses(boxes_.size());
  std::vector<double> score(boxes_.size());
  parallel_for(boxes_.size(), 16, [&](std::size_t b) {
    std::vector<FusedArray> of_box = arrays;
    for (std::size_t i = 0; i < of_box.size(); ++i) {
      of_box[i].log_likelihood = std::span(of_few_[i]).subspan(b * few_.size(), few_.size());
    }
    std::vector<LaneRow> mass(few_.size());
    fuse_rows(of_box, mass);
    masses[b] = uniform(boxes_[b], mean_of(boxes_[b].layer, few_, mass));
    score[b] = boxes_[b].prior * masses[b].sum;
  });
  std::vector<std::size_t> closely = highest(score, most_closely_);
  while (score[closely.back()] < std::exp(-kCloseMargin) * score[closely.front()]) {
    closely.pop_back();
  }
  std::vector<double> heights;
  parallel_for(closely.size(), 1, [&](std::size_t n) {
    const Box& box = boxes_[closely[n]];
    const std::vector<LaneRow> mass = all_places(box, arrays);
    std::vector<double> at;
    for (const HeightSlice& slice : slices_[box.layer]) {
      at.push_back(slice.offset);
    }
    Mass& of_box = masses[closely[n]];
    const auto [sum, where] =
        summarise_masses(lattice_.plan, at, {mass.front().data(), mass.size() * kLaneCount});
    if (sum > kMinSum) {
      of_box.sum = sum / static_cast<double>(lattice_.plan.size());
      of_box.where = where;
    }
  });
  for (std::size_t n = 0; n < cells_.size(); ++n) {
    put_cell(first_[n], first_[n + 1], masses, log_scale, map);
  }
}

// A layer that was not evaluated is taken to be as likely as the evaluated ones.
void TrackedSearch::put_cell(std::size_t first,
                             std::size_t last,
                             const std::vector<Mass>& masses,
                             double log_scale,
                             RoomMap& map) const {
  double sum = 0.0;
  double evaluated = 0.0;
  std::size_t best = first;
  const auto peak = [&](std::size_t b) {
    return layer_weight_[boxes_[b].layer] * masses[b].sum * masses[b].where.best_share;
  };
  for (std::size_t b = first; b < last; ++b) {
    const double weight = layer_weight_[boxes_[b].layer];
    sum += weight * masses[b].sum;
    evaluated += weight;
    best = peak(b) > peak(best) ? b : best;
  }
  const double mean = std::max(sum / evaluated, kMinSum);
  CellMass cell;
  std::vector<WeightedMoments> parts;
  cell.layers.assign(layer_weight_.size(), 0.0F);
  std::size_t b = first;
  for (std::size_t layer = 0; layer < layer_weight_.size(); ++layer) {
    const bool is_evaluated = b < last && boxes_[b].layer == layer;
    const double share =
        layer_weight_[layer] * (is_evaluated && sum > kMinSum ? masses[b].sum / mean : 1.0);
    const Mass mass = is_evaluated ? masses[b] : uniform({0, layer, 0.0}, mean);
    parts.push_back({share, mass.where.all});
    cell.layers[layer] = static_cast<float>(share);
    b += is_evaluated ? 1 : 0;
  }
  cell.all = mixture_of(parts);
  cell.best = masses[best].where.best;
  cell.best_share = std::clamp(peak(best) / mean, 0.0, 1.0);
  if (room_.grid.layers.is_known()) {
    cell.layers.clear();
  }
  const std::size_t number = boxes_[first].number;
  map.log_likelihood[number] = (log_scale + std::log(mean)) / room_.likelihood_exponent;
  map.within.emplace_back(cells_[number], std::move(cell));
}

void search_best_boxes(const TrackedSearch::Room& room,
                       const std::vector<ArrayObservation>& received,
                       std::span<const double> null_model,
                       const AccessPointFusion& fusion,
                       const SearchFocus& focus,
                       RoomMap& map) {
  std::vector<double> score = map.log_likelihood;
  for (double& one : score) {
    one *= room.likelihood_exponent;
  }
  for (std::size_t n = 0; n < focus.log_prior.size(); ++n) {
    score[n] += focus.log_prior[n];
  }
  SearchFocus best;
  best.layer_weight = focus.layer_weight;
  best.cells = highest(score, kMaxTrackedColumns);
  const double top = score[best.cells.front()];
  std::erase_if(best.cells,
                [&](std::size_t cell) { return score[cell] < top - kTrackedColumnMargin; });
  std::sort(best.cells.begin(), best.cells.end());
  for (const std::size_t cell : best.cells) {
    best.log_prior.push_back(score[cell] - top);
  }
  TrackedSearch search(room, received, best);
  search.scan(null_model);
  RoomMap of_best;
  of_best.log_likelihood.resize(search.cells().size());
  search.put_together(fusion, of_best);
  for (std::size_t n = 0; n < search.cells().size(); ++n) {
    map.log_likelihood[search.cells()[n]] = of_best.log_likelihood[n];
  }
  map.within = std::move(of_best.within);
}

}  // namespace rayloc
