#include "engine/localize/place_search.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "engine/base/check.h"
#include "engine/likelihood/lane_kernel.h"

namespace rayloc {
namespace {

constexpr std::size_t kFetchAhead = 2;  // a count, chosen: boxes prefetched before they are needed

}  // namespace

bool PlaceSearch::can_search(const RoomObservation& observation) {
  return std::all_of(
      observation.arrays.begin(), observation.arrays.end(), [](const ArrayObservation& one) {
        return one.map->has_place_boxes() && one.h.size() > one.map->dimension();
      });
}

PlaceSearch::PlaceSearch(const RoomObservation& observation, double likelihood_exponent)
    : likelihood_exponent_(likelihood_exponent) {
  RAYLOC_CHECK(can_search(observation));
  for (const ArrayObservation& one : observation.arrays) {
    Moment moment{&one, delay_rows(one.observed.array, one.h.size()), 0, 0.0F};
    const auto noise = static_cast<double>(moment.rows.noise);
    moment.noise_class = noise_class_of(noise, one.map->access_point().error.noise);
    // The class of the boxes follows from the same noise. The noise estimated from the tones of a
    // single frame is too large.
    ObservedBurst observed = one.observed;
    observed.array.noise = noise;
    moment.null_model = static_cast<float>(one.map->null_model(observed));
    moments_.push_back(std::move(moment));
  }
}

std::vector<std::vector<float>> PlaceSearch::log_likelihoods(const SearchedPlaces& places,
                                                             Spread spread) {
  const std::size_t count = places.x.size();
  RAYLOC_CHECK(places.y.size() == count && places.z.size() == count && places.box.size() == count);
  std::vector<std::vector<float>> result(moments_.size());
  if (moments_.empty()) {
    groups_.clear();
    return result;
  }
  group(places, moments_.front().array->map->box_lattice());
  for (std::size_t i = 0; i < moments_.size(); ++i) {
    evaluate(moments_[i], spread);
    take_values(moments_[i], places, result[i]);
  }
  return result;
}

// The group of a box, a new one at its first appearance.
std::size_t PlaceSearch::group_of(std::uint32_t box) {
  const std::size_t mask = table_.size() - 1;
  std::size_t at = box * std::size_t{2'654'435'761U} & mask;
  while (table_[at] != BoxLattice::kNone && groups_[table_[at]].box != box) {
    at = (at + 1) & mask;
  }
  if (table_[at] == BoxLattice::kNone) {
    table_[at] = static_cast<std::uint32_t>(groups_.size());
    groups_.push_back({box, 0, 0});
  }
  return table_[at];
}

void PlaceSearch::group(const SearchedPlaces& places, const BoxLattice& lattice) {
  const std::size_t count = places.x.size();
  groups_.clear();
  table_.assign(std::bit_ceil(2 * count + 1), BoxLattice::kNone);
  std::vector<std::size_t> of_place(count);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (places.box[i] != BoxLattice::kNone) {
      of_place[i] = group_of(places.box[i]);
      ++groups_[of_place[i]].count;
      ++compared;
    }
  }
  std::size_t first = 0;
  std::vector<std::size_t> next(groups_.size());
  std::vector<Vec3d> middle(groups_.size());
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    groups_[g].first = first;
    next[g] = first;
    first += groups_[g].count;
    middle[g] = lattice.middle(groups_[g].box);
  }
  order_.resize(compared);
  values_.resize(compared);
  x_.resize(compared);
  y_.resize(compared);
  z_.resize(compared);
  const bool is_height_known = lattice.is_height_known();
  for (std::size_t i = 0; i < count; ++i) {
    if (places.box[i] != BoxLattice::kNone) {
      const std::size_t at = next[of_place[i]]++;
      const Vec3d& from = middle[of_place[i]];
      order_[at] = i;
      x_[at] = places.x[i] - static_cast<float>(from.x);
      y_[at] = places.y[i] - static_cast<float>(from.y);
      z_[at] = is_height_known ? 0.0F : places.z[i] - static_cast<float>(from.z);
    }
  }
}

std::size_t PlaceSearch::fullest() const {
  std::size_t best = groups_.size();
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!found_[g]->is_reachable()) {
      continue;
    }
    const Group& one = groups_[g];
    if (best == groups_.size() || one.count > groups_[best].count ||
        (one.count == groups_[best].count && one.box < groups_[best].box)) {
      best = g;
    }
  }
  return best;
}

// Fills values_ for one access point, relative to the null model.
void PlaceSearch::evaluate(const Moment& moment, Spread spread) {
  found_.clear();
  for (const Group& one : groups_) {
    found_.push_back(moment.array->map->place_box(one.box, moment.noise_class));
  }
  std::optional<std::size_t> hint;
  const std::size_t lead = spread == Spread::kTogether ? fullest() : groups_.size();
  if (lead < groups_.size()) {
    evaluate_box(moment, lead, hint);
    hint = burst_.delay;
  }
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (g + kFetchAhead < groups_.size()) {
      fetch(found_[g + kFetchAhead]->block());
    }
    if (g != lead) {
      evaluate_box(moment, g, hint);
    }
  }
}

// hint: the delay found in another box.
void PlaceSearch::evaluate_box(const Moment& moment,
                               std::size_t g,
                               std::optional<std::size_t> hint) {
  const Group& one = groups_[g];
  const PlaceBox& box = *found_[g];
  const auto values = std::span(values_).subspan(one.first, one.count);
  if (!box.is_reachable()) {
    std::fill(values.begin(), values.end(), 0.0F);
    return;
  }
  whiten_delays_of_box(box, moment.rows, hint, burst_);
  const BoxPlaces places{std::span(x_).subspan(one.first, one.count),
                         std::span(y_).subspan(one.first, one.count),
                         std::span(z_).subspan(one.first, one.count)};
  evaluate_places_of_box(box, burst_, places, values);
  for (float& value : values) {
    value -= moment.null_model;
  }
}

// values_ in the order of the places, with the received power.
void PlaceSearch::take_values(const Moment& moment,
                              const SearchedPlaces& places,
                              std::vector<float>& out) {
  out.assign((places.x.size() + kLaneCount - 1) / kLaneCount * kLaneCount, kNotCompared);
  const ArrayObservation& array = *moment.array;
  const Grid& grid = array.map->box_lattice().grid();
  for (std::size_t at = 0; at < order_.size(); ++at) {
    const std::size_t i = order_[at];
    out[i] = values_[at];
    if (!array.power_log_likelihood.empty()) {
      const std::size_t cell =
          grid.cell_at(static_cast<double>(places.x[i]), static_cast<double>(places.y[i]));
      RAYLOC_CHECK(cell < array.power_log_likelihood.size());
      out[i] += static_cast<float>(array.power_log_likelihood_at(cell, likelihood_exponent_));
    }
  }
  if (!places.x.empty()) {
    std::fill(out.begin() + static_cast<std::ptrdiff_t>(places.x.size()),
              out.end(),
              out[places.x.size() - 1]);
  }
}

}  // namespace rayloc
