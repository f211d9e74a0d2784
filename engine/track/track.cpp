#include "engine/track/track.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/highest.h"

namespace rayloc {
namespace {

constexpr double kLeastWeight = 0.02;   // of a burst that is worth working out the map for
constexpr double kLeastMass = 1e-300;   // a probability, chosen: keeps its logarithm finite
constexpr double kLeastChange = 1e-12;  // of the power; less is rounding
// Probabilities, chosen: what a window leaves out, and what of it no burst is compared with ...
constexpr double kOutOfWindow = 1e-4;
constexpr double kNotCompared = 1e-3;  // a probability, chosen
// ... and of being out of the window, from which on the whole room is looked at.
constexpr double kMostAway = 0.02;
constexpr std::size_t kOthers = 128;  // a count, chosen: cells that stand for the rest of the room
// [s], chosen: a step or two of a walk.
constexpr Duration kVelocityWindow = std::chrono::seconds(1);

std::vector<double> logarithm(std::vector<double> mass) {
  for (double& value : mass) {
    value = std::log(std::max(value, kLeastMass));
  }
  return mass;
}

// Of a cell; 0 of one that the burst was not compared with. The first of its cells are in order.
double value_of(const Localizer::Evidence& evidence, std::size_t cell) {
  if (evidence.cells.empty()) {
    return evidence.log_likelihood[cell];
  }
  const auto end = evidence.cells.begin() + static_cast<std::ptrdiff_t>(evidence.weights.ones);
  const auto found = std::lower_bound(evidence.cells.begin(), end, cell);
  return found != end && *found == cell
             ? evidence.log_likelihood[static_cast<std::size_t>(found - evidence.cells.begin())]
             : 0.0;
}

}  // namespace

Track::Track(std::shared_ptr<const Localizer> localizer,
             std::shared_ptr<const FreeSpace> space,
             const TrackOptions& options)
    : localizer_(std::move(localizer)),
      options_(options),
      aligner_(localizer_->room().grid),
      space_(std::move(space)),
      filter_(space_, options.motion) {}

// Share of the power that differs from the last burst, mean over the access points that heard both.
std::optional<double> Track::change_of(const RoomObservation& observation) const {
  double sum = 0.0;
  double count = 0.0;
  for (const HeardArray& now : observation.arrays) {
    for (const HeardArray& before : last_) {
      if (now.ap == before.ap && now.h.size() == before.h.size()) {
        sum += 1.0 - aligner_.align(before.h, now.h).correlation;
        count += 1.0;
      }
    }
  }
  return count > 0.0 ? std::optional(std::max(sum / count, kLeastChange)) : std::nullopt;
}

// 0: no more has changed than by noise and the radio, 1: the device must have moved.
double Track::motion_of(double change, const RoomObservation& observation) const {
  // What lies outside the delays of a room is noise, and both bursts have it.
  double noise = 0.0;
  for (const HeardArray& heard : observation.arrays) {
    noise += 2.0 * (1.0 - heard.observed.array.captured) /
             static_cast<double>(observation.arrays.size());
  }
  return std::clamp(
      std::log(change / (options_.still_change + noise)) / std::log(options_.walking_ratio),
      0.0,
      1.0);
}

// False when no place of the room explains the burst.
bool Track::weigh(const RoomObservation& observation, Duration elapsed) {
  const std::optional<double> change = change_of(observation);
  const double novelty = change ? std::clamp(*change / options_.moved_change, 0.0, 1.0) : 1.0;
  const double credit = credit_ * (1.0 - novelty);
  const double share =
      bursts_ == 0 ? 1.0 : std::min(1.0, to_seconds(elapsed) / to_seconds(options_.evidence_time));
  const double weight = share * (1.0 - credit);
  Localizer::Evidence evidence;
  const std::vector<double>& map = evidence.log_likelihood;
  if (weight >= kLeastWeight) {
    evidence = look(observation);
    if (map.empty()) {
      return false;
    }
  }
  if (change) {
    filter_.weigh_change(motion_of(*change, observation));
  }
  credit_ = credit;
  if (!map.empty()) {
    filter_.update(GridFilter::Sampled{map, evidence.cells, evidence.weights},
                   weight * localizer_->room().likelihood_exponent,
                   evidence.elsewhere);
    within_ = std::move(evidence.within);
    credit_ += weight;
    const auto mass = filter_.mass();
    learn_height(mass, weight);
    const auto peak =
        static_cast<std::size_t>(std::max_element(mass.begin(), mass.end()) - mass.begin());
    loss_ = -value_of(evidence, filter_.window().cell(peak, space_->grid));
  }
  last_ = observation.arrays;
  ++bursts_;
  return true;
}

// At the whole room where the filter has it, and where nothing in the window explains the burst.
Localizer::Evidence Track::look(const RoomObservation& observation) {
  if (filter_.away() > kMostAway) {
    filter_.widen();
  }
  auto evidence = localizer_->evidence(observation, Localizer::Look::kPlaces, focus());
  if (evidence.log_likelihood.empty() && !filter_.window().is_all_of(space_->grid)) {
    filter_.widen();
    evidence = localizer_->evidence(observation, Localizer::Look::kPlaces, focus());
  }
  return evidence;
}

// Where the filter has the device, and how high: what is said of the burst does not depend on it,
// but where the burst is looked at, and where closely.
SearchFocus Track::focus() const {
  SearchFocus focus;
  const CellWindow& window = filter_.window();
  if (!localizer_->heights().is_known()) {
    focus.layer_weight = layers_;
  }
  if (window.is_all_of(space_->grid)) {
    if (!layers_.empty()) {
      focus.log_prior = logarithm(filter_.mass());
    }
    return focus;
  }
  const std::vector<double> mass = filter_.mass();
  const std::vector<std::size_t> order = highest(mass, mass.size());
  double left = 1.0;
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < order.size() && left > kNotCompared; ++i) {
    numbers.push_back(order[i]);
    left -= mass[order[i]];
  }
  std::sort(numbers.begin(), numbers.end());
  for (const std::size_t number : numbers) {
    focus.cells.push_back(window.cell(number, space_->grid));
    focus.log_prior.push_back(std::log(std::max(mass[number], kLeastMass)));
  }
  focus.others = sample_of_others(focus.cells);
  if (focus.others.empty()) {
    focus.cells.clear();
    focus.log_prior.clear();
  }
  return focus;
}

// A lattice over the room, another one with every burst, so that in time all of it is looked at.
// `cells`: in order.
std::vector<std::size_t> Track::sample_of_others(const std::vector<std::size_t>& cells) const {
  const RoomGrid& grid = space_->grid;
  const auto stride = static_cast<std::size_t>(
      std::max(1.0, std::round(std::sqrt(static_cast<double>(grid.size()) / kOthers))));
  // From one lattice to the next by about the golden section of their number.
  const std::size_t lattices = stride * stride;
  const std::size_t turn = bursts_ % lattices *
                           static_cast<std::size_t>(0.618 * static_cast<double>(lattices)) %
                           lattices;
  std::vector<std::size_t> others;
  for (std::size_t x = turn / stride; x < grid.count_x; x += stride) {
    for (std::size_t y = turn % stride; y < grid.count_y; y += stride) {
      const std::size_t cell = x * grid.count_y + y;
      if (space_->free[cell] != 0 && !std::binary_search(cells.begin(), cells.end(), cell)) {
        others.push_back(cell);
      }
    }
  }
  return others;
}

// To where the device may be when `reach` has gone by. The first bursts are of the whole room.
void Track::narrow(Duration reach) {
  if (!options_.is_exhaustive && bursts_ > 0) {
    filter_.narrow(kOutOfWindow, reach);
  }
}

// The height is a probability of each layer, the same wherever the device is. A burst of which only
// a share is new counts by that share.
void Track::learn_height(const std::vector<double>& mass, double weight) {
  const HeightLayers& heights = localizer_->heights();
  if (heights.is_known()) {
    return;
  }
  if (layers_.empty()) {
    layers_ = heights.weight;
  }
  std::vector<double> said(layers_.size());
  double known = 0.0;
  for (const auto& [cell, of_cell] : within_) {
    const auto number = filter_.window().number(cell, space_->grid);
    if (!number) {
      continue;
    }
    for (std::size_t layer = 0; layer < said.size(); ++layer) {
      said[layer] += mass[*number] * static_cast<double>(of_cell.layers[layer]);
    }
    known += mass[*number];
  }
  double sum = 0.0;
  for (std::size_t layer = 0; layer < said.size(); ++layer) {
    // Cells that nobody looked at say nothing of the height.
    const double all = said[layer] + std::max(0.0, 1.0 - known) * layers_[layer];
    layers_[layer] = std::pow(layers_[layer], 1.0 - weight) * std::pow(all, weight);
    sum += layers_[layer];
  }
  for (double& layer : layers_) {
    layer /= sum;
  }
}

// A device that is carried rises and sinks, now and then by much.
void Track::spread_height(double seconds) {
  if (layers_.empty()) {
    return;
  }
  const HeightLayers& heights = localizer_->heights();
  const double steps = options_.height_speed * seconds / heights.thickness;
  const double variance = std::min(0.5, steps * steps);
  const double anew = 1.0 - std::exp(-options_.height_change_rate * seconds);
  std::vector<double> spread(layers_.size());
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const std::size_t low = i > 0 ? i - 1 : i;
    const std::size_t high = i + 1 < layers_.size() ? i + 1 : i;
    spread[low] += 0.5 * variance * layers_[i];
    spread[high] += 0.5 * variance * layers_[i];
    spread[i] += (1.0 - variance) * layers_[i];
  }
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    layers_[i] = (1.0 - anew) * spread[i] + anew * heights.weight[i];
  }
}

void Track::advance(Timestamp time) {
  if (state_) {
    narrow(time - time_);
    filter_.predict(time - time_);
    spread_height(to_seconds(time - time_));
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

FilteredEstimate Track::summarise(LocationEstimate location, const KnownCells& within) const {
  FilteredEstimate estimate;
  location.reason.clear();
  const CellWindow& window = filter_.window();
  KnownCells in_window;
  for (const auto& [cell, mass] : within) {
    if (const auto number = window.number(cell, space_->grid)) {
      in_window.emplace_back(*number, mass);
    }
  }
  summarise_posterior(window.grid_of(space_->grid),
                      logarithm(filter_.mass()),
                      {1.0,
                       location.accuracy_confidence,
                       localizer_->options().max_hypotheses,
                       filter_.away(),
                       localizer_->room().least_sigma,
                       static_cast<double>(space_->grid.size())},
                      location,
                      in_window);
  location.loss = loss_;
  estimate.location = std::move(location);
  estimate.standing = filter_.standing();
  return estimate;
}

// Slope of the positions of the last second, in least squares.
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

tl::expected<FilteredEstimate, MomentRefusal> Track::hear(std::span<const CsiFrame> frames) {
  RoomObservation observation = localizer_->hear(frames);
  const Timestamp time = observation.estimate.time;
  if (state_ && time <= time_) {
    return tl::make_unexpected(MomentRefusal::kOutOfOrder);
  }
  if (observation.arrays.empty()) {
    return tl::make_unexpected(MomentRefusal::kUnusable);
  }
  const Duration elapsed = time - heard_;
  advance(time);
  if (!weigh(observation, elapsed)) {
    return tl::make_unexpected(MomentRefusal::kUnexplained);
  }
  heard_ = time;
  FilteredEstimate estimate = summarise(std::move(observation.estimate), within_);
  remember(estimate);
  if (!state_ && bursts_ < options_.confirming_bursts) {
    enter(TrackState::kTentative, time, "heard for the first time", estimate);
  } else if (bursts_ >= options_.confirming_bursts) {
    enter(TrackState::kConfirmed, time, "heard often enough", estimate);
  } else {
    estimate.state = *state_;
  }
  return estimate;
}

FilteredEstimate Track::predict(Timestamp time) {
  advance(time);
  fixes_.clear();
  LocationEstimate location;
  location.accuracy_confidence = localizer_->options().accuracy_confidence;
  location.time = time;
  location.capture_start = heard_;
  location.capture_end = heard_;
  FilteredEstimate estimate = summarise(std::move(location), {});
  estimate.predicted = true;
  return estimate;
}

FilteredEstimate Track::end(std::string reason) {
  // Later than the last estimate: what is said of an instant has one name (event_id).
  const Timestamp time = time_ + std::chrono::microseconds(1);
  FilteredEstimate estimate = predict(time);
  enter(TrackState::kLost, time, std::move(reason), estimate);
  return estimate;
}

std::optional<FilteredEstimate> Track::coast(Timestamp now) {
  if (!state_ || now < time_ || *state_ == TrackState::kLost ||
      now - heard_ < options_.coast_after) {
    return std::nullopt;
  }
  FilteredEstimate estimate = predict(now);
  const Duration silence = now - heard_;
  const bool tentative = *state_ == TrackState::kTentative;
  if (silence >= (tentative ? options_.forget_after : options_.lose_after)) {
    enter(TrackState::kLost, now, "not heard for too long", estimate);
  } else if (!tentative) {
    enter(TrackState::kCoasting, now, "not heard lately", estimate);
  }
  return estimate;
}

}  // namespace rayloc
