#include "engine/track/track.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rayloc {
namespace {

constexpr double kLeastWeight = 0.02;  // of a burst that is worth working out the map for
constexpr double kLeastMass = 1e-300;
constexpr Duration kVelocityWindow = std::chrono::seconds(1);

std::vector<double> logarithm(std::vector<double> mass) {
  for (double& value : mass) {
    value = std::log(std::max(value, kLeastMass));
  }
  return mass;
}

}  // namespace

Track::Track(std::shared_ptr<const Localizer> localizer,
             std::shared_ptr<const FreeSpace> space,
             const TrackOptions& options)
    : localizer_(std::move(localizer)),
      options_(options),
      aligner_(localizer_->room().grid),
      filter_(std::move(space), options.motion) {}

// Mean over the access points that heard both bursts; as by a move when none did.
double Track::change_of(const Hearing& hearing) const {
  double sum = 0.0;
  double count = 0.0;
  for (const HeardArray& now : hearing.arrays) {
    for (const HeardArray& before : last_) {
      if (now.station == before.station) {
        sum += 1.0 - aligner_.align(before.h, now.h).correlation;
        count += 1.0;
      }
    }
  }
  return count > 0.0 ? std::clamp(sum / (count * options_.moved_change), 0.0, 1.0) : 1.0;
}

// False when no place of the room explains the burst.
bool Track::weigh(const Hearing& hearing) {
  const double change = change_of(hearing);
  const double credit = credit_ * (1.0 - change);
  const double weight = options_.exponent * (1.0 - credit);
  if (weight >= kLeastWeight) {
    const auto map = localizer_->log_likelihood(hearing);
    if (*std::max_element(map.begin(), map.end()) <= 0.0) {
      return false;
    }
    if (bursts_ > 0) {
      filter_.weigh_change(change);
    }
    filter_.update(map, weight * localizer_->room().temper);
    credit_ = credit + weight;
    const auto mass = filter_.mass();
    const auto peak = std::max_element(mass.begin(), mass.end()) - mass.begin();
    loss_ = -map[static_cast<std::size_t>(peak)];
  } else {
    filter_.weigh_change(change);
    credit_ = credit;
  }
  last_ = hearing.arrays;
  ++bursts_;
  return true;
}

void Track::advance(Timestamp time) {
  if (state_) {
    filter_.predict(time - time_);
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

FilteredEstimate Track::summarise(LocationEstimate location) const {
  FilteredEstimate estimate;
  location.reason.clear();
  summarise_posterior(localizer_->grid(),
                      logarithm(filter_.mass()),
                      {1.0, location.accuracy_confidence, localizer_->options().max_hypotheses},
                      location);
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

std::optional<FilteredEstimate> Track::hear(std::span<const CsiFrame> frames) {
  Hearing hearing = localizer_->hear(frames);
  const Timestamp time = hearing.estimate.time;
  if (state_ && time <= time_) {
    ++out_of_order_;
    return std::nullopt;
  }
  if (hearing.arrays.empty()) {
    return std::nullopt;
  }
  advance(time);
  if (!weigh(hearing)) {
    return std::nullopt;
  }
  heard_ = time;
  FilteredEstimate estimate = summarise(std::move(hearing.estimate));
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

std::optional<FilteredEstimate> Track::coast(Timestamp now) {
  if (!state_ || now < time_ || *state_ == TrackState::kLost ||
      now - heard_ < options_.coast_after) {
    return std::nullopt;
  }
  advance(now);
  fixes_.clear();
  LocationEstimate location;
  location.accuracy_confidence = localizer_->options().accuracy_confidence;
  location.time = now;
  location.capture_start = heard_;
  location.capture_end = heard_;
  FilteredEstimate estimate = summarise(std::move(location));
  estimate.predicted = true;
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
