#include "engine/track/follow/grid_follower.h"

#include <algorithm>
#include <utility>

#include "engine/base/highest.h"
#include "engine/grid/cell_set.h"
#include "engine/track/filter_summary.h"
#include "engine/track/hand_over.h"
#include "engine/track/searched_cells.h"

namespace rayloc {
namespace {

// Counts of cells, chosen: kept by a resting track, with 17 modes 29 KiB ...
constexpr std::size_t kCompactCells = 400;
constexpr std::size_t kCompactRefined = 64;  // a count, chosen: ... with positions in the cell

// Log-likelihood of a cell; 0 for a cell that was not compared. The cells are in ascending order.
double value_of(const Localizer::Evidence& evidence, const Grid& grid, std::size_t cell) {
  const CellSet& evaluated = evidence.evaluated;
  if (evaluated.is_all()) {
    return evidence.log_likelihood[cell];
  }
  const auto first = evaluated.cells.begin();
  const auto end = first + static_cast<std::ptrdiff_t>(evaluated.ones(grid));
  const auto found = std::lower_bound(first, end, cell);
  return found != end && *found == cell
             ? evidence.log_likelihood[static_cast<std::size_t>(found - first)]
             : 0.0;
}

}  // namespace

GridFollower::GridFollower(std::shared_ptr<const Localizer> localizer,
                           std::shared_ptr<const FreeSpace> space,
                           const TrackOptions& options,
                           Duration phase)
    : phase_(phase),
      localizer_(std::move(localizer)),
      options_(options),
      space_(std::move(space)),
      filter_(space_, options.motion) {}

void GridFollower::continue_from(const PlaceCloud& cloud,
                                 double elsewhere,
                                 WeighedAccessPoints weighed,
                                 Timestamp time) {
  filter_ = grid_of(cloud, space_, options_.motion, elsewhere);
  std::vector<double> layers = layers_of(cloud, space_->grid);
  for (std::size_t i = 0; i < layers.size(); ++i) {
    layers[i] = (1.0 - elsewhere) * layers[i] + elsewhere * space_->grid.layers.weight[i];
  }
  layers_.set(std::move(layers));
  weighed_ = std::move(weighed);
  has_begun_ = true;
  time_ = time;
}

std::optional<double> GridFollower::weigh(const TrackedMoment& moment) {
  // Evidence from access points that join is entirely new, unless the device has rested since it
  // was weighed. So is the first moment after a cloud, or after the target might have been
  // anywhere: it decides between the places of the filter and all others.
  const bool is_joining = !moment.is_rest && weighed_.is_joined_by(moment.observation, time_);
  const bool is_new = is_joining || is_unlocated_;
  const double credit = is_new ? 0.0 : moment.credit;
  const Duration unseen = time_ - searched_;  // without evidence outside the window
  const CellWindow compared = filter_.window();
  bool is_wide = widens(is_joining);
  const auto weight_of = [&](Duration since) {
    return (is_new ? 1.0 : snapshot_share(since, options_.evidence_time)) * (1.0 - credit);
  };
  MomentWeights weights{weight_of(moment.elapsed), weight_of(moment.elapsed)};
  const double of_unseen = weight_of(std::max(moment.elapsed, unseen));
  Localizer::Evidence evidence;
  if ((is_wide ? of_unseen : weights.window) >= kMinBurstWeight) {
    if (is_joining) {  // evaluated again soon: one burst of a joining access point may mislead
      whole_room_period_ = kFirstWholeRoomPeriod;
    }
    evidence = evaluate(moment.observation, is_wide);
    if (evidence.log_likelihood.empty()) {
      return std::nullopt;
    }
  }
  if (moment.motion) {
    filter_.weigh_change(*moment.motion);
  }
  double weight = 0.0;
  if (!evidence.log_likelihood.empty()) {
    weights.room = is_wide ? of_unseen : weights.window;
    weight = take(std::move(evidence), compared, weights);
  }
  // Also a moment that was not compared: the present channel has had its weight.
  weighed_.note(moment.observation, time_);
  ++moments_;
  has_begun_ = true;
  is_unlocated_ = false;
  return credit + weight;
}

// Updates with the evidence of a moment; returns its weight, averaged over the mass of the cells.
// `compared`: the window that moments were compared with before.
//
// Cells outside it have had no evidence of their own since the room was evaluated, so the moment
// counts for all of that time when the window as a whole is compared with them. Otherwise no single
// evaluation could leave a wrongly followed peak, because the next window would again exclude the
// small mass that was given to the right one.
double GridFollower::take(Localizer::Evidence evidence,
                          const CellWindow& compared,
                          const MomentWeights& weights) {
  const Grid& grid = space_->grid;
  const double exponent = localizer_->room().likelihood_exponent;
  const bool is_tempered = weights.window < weights.room;
  std::vector<double> tempered;
  if (is_tempered) {
    tempered = tempered_in_window(
        evidence.log_likelihood, filter_.mass(), compared, grid, exponent, weights);
  }
  filter_.update(is_tempered ? tempered : evidence.log_likelihood,
                 evidence.evaluated,
                 weights.room * exponent,
                 evidence.outlier);
  within_ = std::move(evidence.within);
  const auto mass = filter_.mass();
  double weight = weights.room;
  if (is_tempered) {
    double before = 0.0;  // of the cells that were compared before
    for (std::size_t n = 0; n < compared.size(); ++n) {
      before += mass[compared.cell(n, grid)];
    }
    weight += before * (weights.window - weights.room);
  }
  if (!grid.layers.is_known()) {
    layers_.learn(grid.layers, layer_mass_of(within_, mass, filter_.window(), grid), weight);
  }
  const auto peak =
      static_cast<std::size_t>(std::max_element(mass.begin(), mass.end()) - mass.begin());
  loss_ = -value_of(evidence, grid, filter_.window().cell(peak, grid));
  return weight;
}

// Periodically, when an access point joins, and when the filter has the target in another place: a
// wrongly followed peak explains enough to be followed on.
bool GridFollower::widens(bool is_joining) const {
  const bool is_due = is_search_due(time_, searched_, whole_room_period_, phase_);
  return !filter_.window().is_all_of(space_->grid) &&
         (is_due || filter_.away() > kMaxAway || is_joining);
}

// Also evaluates the whole room if no place in the window explains the burst: then `is_wide`.
Localizer::Evidence GridFollower::evaluate(const RoomObservation& observation, bool& is_wide) {
  const auto search_wide = [&] {
    filter_.widen();
    whole_room_period_ = std::min(2 * whole_room_period_, kWholeRoomPeriod);
  };
  if (is_wide) {
    search_wide();
  } else if (filter_.window().is_all_of(space_->grid)) {
    whole_room_period_ = kFirstWholeRoomPeriod;
  }
  auto evidence = localizer_->evidence(observation, Localizer::Scan::kPlaces, focus());
  if (evidence.log_likelihood.empty() && !filter_.window().is_all_of(space_->grid)) {
    is_wide = true;
    search_wide();
    evidence = localizer_->evidence(observation, Localizer::Scan::kPlaces, focus());
  }
  if (filter_.window().is_all_of(space_->grid)) {
    searched_ = time_;
  }
  return evidence;
}

// Cells and heights that the filter gives for the device. They select where the burst is evaluated,
// and where finely; they do not change its likelihoods.
SearchFocus GridFollower::focus() const {
  SearchFocus focus;
  focus.is_quick = !options_.is_exhaustive;
  if (!localizer_->grid().layers.is_known()) {
    focus.layer_weight = layers_.weights();
  }
  SearchedCells searched = searched_cells(filter_, *space_, moments_);
  if (!searched.is_all()) {
    focus.log_prior = log_masses(std::move(searched.mass));
    focus.cells = std::move(searched.cells);
    focus.others = std::move(searched.others);
  } else if (filter_.window().is_all_of(space_->grid) && !layers_.weights().empty()) {
    focus.log_prior = log_masses(filter_.mass());
  }
  return focus;
}

// Narrows to the area reachable within `reach`. The first bursts use the whole room.
void GridFollower::narrow(Duration reach) {
  if (!options_.is_exhaustive) {
    filter_.narrow(kOutOfWindow, reach);
  }
}

void GridFollower::advance(Timestamp time) {
  if (has_begun_) {
    narrow(time - time_);
    filter_.predict(time - time_);
    layers_.spread(localizer_->grid().layers,
                   {options_.height_speed, options_.height_change_rate},
                   to_seconds(time - time_));
  }
  time_ = time;
}

void GridFollower::rest(Timestamp time) {
  if (has_begun_) {
    narrow(Duration{});
  }
  time_ = time;
}

void GridFollower::summarise(const PosteriorOptions& options,
                             bool is_predicted,
                             LocationEstimate& location) const {
  const RefinedCells nothing;
  summarise_filter(filter_, space_->grid, options, is_predicted ? nothing : within_, location);
  location.loss = loss_;
}

void GridFollower::compact() {
  const bool is_small =
      within_.size() <= kCompactRefined && filter_.window().size() <= kCompactCells;
  if (options_.is_exhaustive || filter_.is_compact() || is_small) {
    return;
  }
  const std::vector<double> mass = filter_.mass();
  if (within_.size() > kCompactRefined) {
    std::vector<double> of_cells;
    of_cells.reserve(within_.size());
    for (const auto& [cell, of_cell] : within_) {
      const auto number = filter_.window().number(cell, space_->grid);
      of_cells.push_back(number ? mass[*number] : 0.0);
    }
    std::vector<std::size_t> best = highest(of_cells, kCompactRefined);
    std::sort(best.begin(), best.end());
    RefinedCells kept;
    kept.reserve(best.size());
    for (const std::size_t i : best) {
      kept.push_back(std::move(within_[i]));
    }
    within_ = std::move(kept);
  }
  filter_.compact(kCompactCells, mass);
}

void GridFollower::forget_place() {
  filter_ = GridFilter(space_, options_.motion);
  weighed_ = {};
  is_unlocated_ = true;
  loss_ = 0.0;
  within_.clear();
  layers_.forget();
}

}  // namespace rayloc
