#include "engine/track/track.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/highest.h"
#include "engine/grid/cell_set.h"
#include "engine/track/filter_summary.h"
#include "engine/track/searched_cells.h"

namespace rayloc {
namespace {

constexpr double kMinBurstWeight = 0.02;  // least weight of a burst for which the map is computed
// Counts of cells, chosen: kept by a resting track, with 17 modes 29 KiB ...
constexpr std::size_t kCompactCells = 400;
constexpr std::size_t kCompactRefined = 64;  // a count, chosen: ... with positions in the cell
// [s], chosen: a step or two of a walk.
constexpr Duration kVelocityWindow = std::chrono::seconds(1);

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

Track::Track(std::shared_ptr<const Localizer> localizer,
             std::shared_ptr<const FreeSpace> space,
             const TrackOptions& options,
             Duration phase)
    : phase_(phase),
      localizer_(std::move(localizer)),
      options_(options),
      change_(localizer_->room().grid, {options.still_change, options.walking_ratio}),
      space_(std::move(space)),
      filter_(space_, options.motion),
      whole_room_period_(kFirstWholeRoomPeriod) {}

// False when no place of the room explains the burst.
bool Track::weigh(const RoomObservation& observation, Duration elapsed) {
  const std::optional<double> change = change_.of(observation);
  const double novelty = change ? std::clamp(*change / options_.moved_change, 0.0, 1.0) : 1.0;
  // Evidence from access points that join is entirely new, also for a device at rest.
  const bool is_joining = is_joined(observation);
  const double credit = is_joining ? 0.0 : credit_ * (1.0 - novelty);
  const Duration unseen = time_ - searched_;  // without evidence outside the window
  bool is_wide = widens(is_joining);
  // Cells that enter the window have had no evidence of their own since then, so this burst counts
  // for all of that time. Otherwise no single evaluation could leave a wrongly followed peak,
  // because the next window would again exclude the small mass that was given to the right one.
  const bool is_new = is_unlocated_ || is_joining;
  const auto weight_of_burst = [&] {
    const Duration since = is_wide ? std::max(elapsed, unseen) : elapsed;
    const double share =
        is_new ? 1.0 : std::min(1.0, to_seconds(since) / to_seconds(options_.evidence_time));
    return share * (1.0 - credit);
  };
  double weight = weight_of_burst();
  Localizer::Evidence evidence;
  const std::vector<double>& map = evidence.log_likelihood;
  if (weight >= kMinBurstWeight) {
    if (is_joining) {  // evaluated again soon: one burst of a joining access point may mislead
      whole_room_period_ = kFirstWholeRoomPeriod;
    }
    evidence = evaluate(observation, is_wide);
    if (map.empty()) {
      return false;
    }
    weight = weight_of_burst();
  }
  if (change) {
    filter_.weigh_change(change_.motion_of(*change, observation));
  }
  credit_ = credit;
  if (!map.empty()) {
    filter_.update(
        map, evidence.evaluated, weight * localizer_->room().likelihood_exponent, evidence.outlier);
    within_ = std::move(evidence.within);
    credit_ += weight;
    searched_with_.resize(localizer_->room().access_points.size());
    for (const ArrayObservation& received : observation.arrays) {
      searched_with_[received.ap] = time_;
    }
    const auto mass = filter_.mass();
    const Grid& grid = localizer_->grid();
    if (!grid.layers.is_known()) {
      layers_.learn(grid.layers, layer_mass_of(within_, mass, filter_.window(), grid), weight);
    }
    const auto peak =
        static_cast<std::size_t>(std::max_element(mass.begin(), mass.end()) - mass.begin());
    loss_ = -value_of(evidence, space_->grid, filter_.window().cell(peak, space_->grid));
  }
  change_.remember(observation);
  ++bursts_;
  is_unlocated_ = false;
  return true;
}

// True if one of its access points was absent or suspect in every burst weighed in the last
// seconds: it may separate places that all others find alike.
bool Track::is_joined(const RoomObservation& observation) const {
  return std::any_of(
      observation.arrays.begin(), observation.arrays.end(), [&](const ArrayObservation& received) {
        return received.ap >= searched_with_.size() || !searched_with_[received.ap] ||
               time_ - *searched_with_[received.ap] > kWholeRoomPeriod;
      });
}

// Periodically, when an access point joins, and when the filter has the target in another place: a
// wrongly followed peak explains enough to be followed on.
bool Track::widens(bool is_joining) const {
  // By frame time, not by the track's begin, so that a successor evaluates at the same times.
  const auto number = [&](Timestamp time) {
    return (time.time_since_epoch() + phase_) / whole_room_period_;
  };
  const bool is_due = number(time_) != number(searched_);
  return !filter_.window().is_all_of(space_->grid) &&
         (is_due || filter_.away() > kMaxAway || is_joining);
}

// Also evaluates the whole room if no place in the window explains the burst: then `is_wide`.
Localizer::Evidence Track::evaluate(const RoomObservation& observation, bool& is_wide) {
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
SearchFocus Track::focus() const {
  SearchFocus focus;
  focus.is_quick = !options_.is_exhaustive;
  if (!localizer_->grid().layers.is_known()) {
    focus.layer_weight = layers_.weights();
  }
  SearchedCells searched = searched_cells(filter_, *space_, bursts_);
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
void Track::narrow(Duration reach) {
  if (!options_.is_exhaustive && bursts_ > 0) {
    filter_.narrow(kOutOfWindow, reach);
  }
}

void Track::advance(Timestamp time) {
  if (state_) {
    narrow(time - time_);
    filter_.predict(time - time_);
    layers_.spread(localizer_->grid().layers,
                   {options_.height_speed, options_.height_change_rate},
                   to_seconds(time - time_));
  }
  time_ = time;
}

void Track::enter(TrackState state,
                  Timestamp time,
                  std::string reason,
                  FilteredEstimate& estimate) {
  estimate.state = state;
  if (state_ != state) {
    estimate.transition = TrackTransition{time, state_, state, std::move(reason)};
    state_ = state;
  }
}

FilteredEstimate Track::summarise(LocationEstimate location, const RefinedCells& within) const {
  FilteredEstimate estimate;
  location.reason.clear();
  summarise_filter(filter_,
                   space_->grid,
                   {1.0,
                    location.accuracy_confidence,
                    localizer_->options().max_hypotheses,
                    fault_.probability,
                    localizer_->room().sigma_floor},
                   within,
                   location);
  location.loss = loss_;
  estimate.location = std::move(location);
  estimate.stationary = filter_.stationary();
  return estimate;
}

// Least-squares slope of the positions of the last second.
void Track::remember(FilteredEstimate& estimate) {
  if (!estimate.location.position) {
    return;
  }
  fixes_.push_back({time_, *estimate.location.position});
  while (fixes_.front().time < time_ - kVelocityWindow) {
    fixes_.pop_front();
  }
  if (time_ - fixes_.front().time < kVelocityWindow / 2) {
    return;
  }
  double mean_time = 0.0;
  Vec3d mean;
  const double scale = 1.0 / static_cast<double>(fixes_.size());
  for (const Fix& fix : fixes_) {
    mean_time += scale * to_seconds(fix.time - time_);
    mean = mean + scale * fix.position;
  }
  double spread = 0.0;
  Vec3d product;
  for (const Fix& fix : fixes_) {
    const double t = to_seconds(fix.time - time_) - mean_time;
    spread += t * t;
    product = product + t * (fix.position - mean);
  }
  estimate.velocity = (1.0 / spread) * product;
}

void Track::compact() {
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

void Track::forget_place() {
  filter_ = GridFilter(space_, options_.motion);
  is_unlocated_ = true;
  credit_ = 0.0;
  loss_ = 0.0;
  within_.clear();
  layers_.forget();
  change_.forget();
  fixes_.clear();
}

tl::expected<FilteredEstimate, MomentRefusal> Track::receive(std::span<const CsiFrame> frames,
                                                             const FrameFault& fault) {
  filter_.wake();
  RoomObservation observation = localizer_->receive(frames);
  const Timestamp time = observation.estimate.time;
  if (state_ && time <= time_) {
    return tl::make_unexpected(MomentRefusal::kOutOfOrder);
  }
  if (observation.arrays.empty()) {
    return tl::make_unexpected(MomentRefusal::kUnusable);
  }
  const Duration elapsed = time - received_;
  advance(time);
  if (!weigh(observation, elapsed)) {
    return tl::make_unexpected(MomentRefusal::kUnexplained);
  }
  received_ = time;
  fault_ = fault;
  FilteredEstimate estimate = summarise(std::move(observation.estimate), within_);
  remember(estimate);
  if (!state_ && bursts_ < options_.confirming_bursts) {
    enter(TrackState::kTentative, time, "received for the first time", estimate);
  } else if (bursts_ >= options_.confirming_bursts) {
    enter(TrackState::kConfirmed, time, "received often enough", estimate);
  } else {
    estimate.state = *state_;
  }
  return estimate;
}

FilteredEstimate Track::predict(Timestamp time) {
  filter_.wake();
  advance(time);
  fixes_.clear();
  LocationEstimate location;
  location.accuracy_confidence = localizer_->options().accuracy_confidence;
  location.time = time;
  location.capture_start = received_;
  location.capture_end = received_;
  FilteredEstimate estimate = summarise(std::move(location), {});
  estimate.predicted = true;
  return estimate;
}

FilteredEstimate Track::end(std::string reason) {
  // Later than the last estimate, because an event of one instant has one name (event_id).
  const Timestamp time = time_ + std::chrono::microseconds(1);
  FilteredEstimate estimate = predict(time);
  enter(TrackState::kLost, time, std::move(reason), estimate);
  return estimate;
}

std::optional<FilteredEstimate> Track::coast(Timestamp now) {
  if (!state_ || now < time_ || *state_ == TrackState::kLost ||
      now - received_ < options_.coast_after) {
    return std::nullopt;
  }
  FilteredEstimate estimate = predict(now);
  const Duration silence = now - received_;
  const bool tentative = *state_ == TrackState::kTentative;
  if (silence >= (tentative ? options_.forget_after : options_.lose_after)) {
    enter(TrackState::kLost, now, "not received for too long", estimate);
  } else if (!tentative) {
    enter(TrackState::kCoasting, now, "not received lately", estimate);
  }
  return estimate;
}

}  // namespace rayloc
