#include "engine/track/track.h"

#include <algorithm>
#include <utility>

#include "engine/track/moved_estimate.h"

namespace rayloc {

Track::Track(std::shared_ptr<const Localizer> localizer,
             std::shared_ptr<const FreeSpace> space,
             const TrackOptions& options,
             Duration phase,
             CloudSource cloud)
    : localizer_(std::move(localizer)),
      options_(options),
      channel_(localizer_->room().grid,
               {options.still_change, options.walking_ratio, options.moved_change}),
      filter_(localizer_, std::move(space), options, phase, std::move(cloud)) {}

// The credit of the present channel after the burst; empty when no place of the room explains it.
std::optional<double> Track::weigh(const RoomObservation& observation,
                                   const std::optional<TargetChannel::Change>& change,
                                   std::span<const CsiFrame> frames,
                                   Duration elapsed) {
  const bool is_rest = change && change->is_rest;
  double novelty = 1.0;  // an access point without a remembered array has had no weight
  std::optional<double> motion;
  if (change) {
    if (change->shows_motion) {
      motion = channel_.motion_of(*change);
    }
    if (change->is_of_all) {
      novelty = is_rest ? 0.0 : std::min(1.0, change->power / options_.moved_change);
    }
  }
  const auto credit =
      filter_.weigh({observation, frames, elapsed, motion, credit_ * (1.0 - novelty), is_rest});
  // While noise explains the changes the remembered arrays stay, so that a slow movement adds up.
  if (credit && novelty > 0.0) {
    channel_.remember(observation);
  }
  return credit;
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

FilteredEstimate Track::summarise(LocationEstimate location, bool is_predicted) {
  FilteredEstimate estimate;
  location.reason.clear();
  filter_.summarise({1.0,
                     location.accuracy_confidence,
                     localizer_->options().max_hypotheses,
                     fault_.probability,
                     localizer_->room().sigma_floor},
                    is_predicted,
                    location);
  estimate.location = std::move(location);
  estimate.stationary = filter_.stationary();
  return estimate;
}

void Track::remember(FilteredEstimate& estimate) {
  if (estimate.location.position) {
    fixes_.add(filter_.time(), *estimate.location.position);
    estimate.velocity = filter_.velocity(*estimate.location.position);
    if (!estimate.velocity) {
      estimate.velocity = fixes_.velocity();
    }
  }
}

void Track::compact() { filter_.compact(); }

void Track::forget_place() {
  filter_.forget_place();
  before_silence_.reset();
  credit_ = 0.0;
  channel_.forget();
  fixes_.clear();
  last_.reset();
}

tl::expected<FilteredEstimate, MomentRefusal> Track::receive(std::span<const CsiFrame> frames,
                                                             const FrameFault& fault) {
  if (!filter_.is_due(frames) && last_) {
    return move_estimate(frames);
  }
  filter_.wake();
  RoomObservation observation = localizer_->receive(
      frames,
      filter_.is_in_cloud() ? Localizer::Precision::kSingle : Localizer::Precision::kDouble);
  const Timestamp time = observation.estimate.time;
  if (state_ && time <= std::max(filter_.time(), received_)) {
    return tl::make_unexpected(MomentRefusal::kOutOfOrder);
  }
  if (observation.arrays.empty()) {
    return tl::make_unexpected(MomentRefusal::kUnusable);
  }
  const Duration elapsed = time - weighed_;
  const std::optional<TargetChannel::Change> change = channel_.of(observation);
  if (change && change->is_rest) {
    if (before_silence_) {
      filter_ = *std::move(before_silence_);
      before_silence_.reset();
      filter_.wake();
    }
    filter_.rest(time);
  } else {
    filter_.advance(time);
  }
  const std::optional<double> credit = weigh(observation, change, frames, elapsed);
  if (!credit) {
    return tl::make_unexpected(MomentRefusal::kUnexplained);
  }
  before_silence_.reset();
  credit_ = *credit;
  ++bursts_;
  received_ = time;
  weighed_ = time;
  fault_ = fault;
  FilteredEstimate estimate = summarise(std::move(observation.estimate), false);
  remember(estimate);
  if (!state_ && bursts_ < options_.confirming_bursts) {
    enter(TrackState::kTentative, time, "received for the first time", estimate);
  } else if (bursts_ >= options_.confirming_bursts) {
    enter(TrackState::kConfirmed, time, "received often enough", estimate);
  } else {
    estimate.state = *state_;
  }
  filter_.settle(state_ == TrackState::kConfirmed);
  last_.reset();
  if (filter_.is_in_cloud()) {
    last_ = estimate;
  }
  return estimate;
}

// Frames that need no evaluation. They count as received: the next ones are later.
tl::expected<FilteredEstimate, MomentRefusal> Track::move_estimate(
    std::span<const CsiFrame> frames) {
  FilteredEstimate estimate = moved_estimate(*last_, frames, filter_.velocity_variance());
  if (estimate.location.time <= std::max(filter_.time(), received_)) {
    return tl::make_unexpected(MomentRefusal::kOutOfOrder);
  }
  received_ = estimate.location.time;
  return estimate;
}

FilteredEstimate Track::predict(Timestamp time) {
  if (!before_silence_) {
    filter_.compact();
    before_silence_ = filter_;
  }
  filter_.wake();
  filter_.advance(time);
  fixes_.clear();
  LocationEstimate location;
  location.accuracy_confidence = localizer_->options().accuracy_confidence;
  location.time = time;
  location.capture_start = received_;
  location.capture_end = received_;
  FilteredEstimate estimate = summarise(std::move(location), true);
  estimate.predicted = true;
  return estimate;
}

FilteredEstimate Track::end(std::string reason) {
  // Later than the last estimate, because an event of one instant has one name (event_id).
  const Timestamp time = std::max(filter_.time(), received_) + std::chrono::microseconds(1);
  FilteredEstimate estimate = predict(time);
  enter(TrackState::kLost, time, std::move(reason), estimate);
  return estimate;
}

std::optional<FilteredEstimate> Track::coast(Timestamp now) {
  if (!state_ || now < filter_.time() || *state_ == TrackState::kLost ||
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
