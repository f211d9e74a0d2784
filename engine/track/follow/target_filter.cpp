#include "engine/track/follow/target_filter.h"

#include <utility>

#include "engine/track/follow/hand_over_rules.h"
#include "engine/track/hand_over.h"

namespace rayloc {

TargetFilter::TargetFilter(std::shared_ptr<const Localizer> localizer,
                           std::shared_ptr<const FreeSpace> space,
                           TrackOptions options,
                           Duration phase,
                           CloudSource source)
    : localizer_(std::move(localizer)),
      space_(std::move(space)),
      options_(std::move(options)),
      phase_(phase),
      source_(std::move(source)),
      grid_(std::make_unique<GridFollower>(localizer_, space_, options_, phase_)) {}

TargetFilter::TargetFilter(const TargetFilter& other)
    : localizer_(other.localizer_),
      space_(other.space_),
      options_(other.options_),
      phase_(other.phase_),
      source_(other.source_),
      time_(other.time_),
      acquiring_since_(other.acquiring_since_),
      grid_(other.grid_ ? std::make_unique<GridFollower>(*other.grid_) : nullptr),
      cloud_(other.cloud_ ? std::make_unique<CloudFollower>(*other.cloud_) : nullptr) {}

void TargetFilter::compact() {
  if (grid_) {
    grid_->compact();
  }
}

void TargetFilter::wake() {
  if (grid_) {
    grid_->wake();
  }
}

void TargetFilter::advance(Timestamp time) {
  if (cloud_) {
    cloud_->advance(time);
  } else {
    grid_->advance(time);
  }
  time_ = time;
}

void TargetFilter::rest(Timestamp time) {
  if (cloud_) {
    cloud_->rest(time);
  } else {
    grid_->rest(time);
  }
  time_ = time;
}

std::optional<double> TargetFilter::weigh(const TrackedMoment& moment) {
  if (cloud_) {
    if (const auto credit = cloud_->weigh(moment)) {
      return credit;
    }
    to_grid();
  }
  const auto credit = grid_->weigh(moment);
  if (credit && !acquiring_since_) {
    acquiring_since_ = time_;
  }
  return credit;
}

void TargetFilter::forget_place() {
  acquiring_since_.reset();
  if (grid_) {
    grid_->forget_place();
  } else {
    cloud_.reset();
    grid_ = std::make_unique<GridFollower>(localizer_, space_, options_, phase_);
  }
}

void TargetFilter::summarise(PosteriorOptions options,
                             bool is_predicted,
                             LocationEstimate& location) {
  const WeighedAccessPoints& weighed = cloud_ ? cloud_->weighed() : grid_->weighed();
  options.region_exponent = weighed.recent() == 1 ? options_.lone_exponent : 1.0;
  if (cloud_) {
    cloud_->summarise(options, location);
  } else {
    grid_->summarise(options, is_predicted, location);
  }
}

double TargetFilter::stationary() const {
  return cloud_ ? cloud_->stationary() : grid_->stationary();
}

std::optional<Vec3d> TargetFilter::velocity(const Vec3d& position) const {
  return cloud_ ? std::optional(cloud_->velocity(position)) : std::nullopt;
}

double TargetFilter::velocity_variance() const {
  return cloud_ ? cloud_->velocity_variance() : 0.0;
}

void TargetFilter::settle(bool is_confirmed) {
  if (cloud_) {
    if (!cloud_->settle()) {
      to_grid();
    }
  } else if (source_.room && is_confirmed && acquiring_since_ &&
             hands_over(
                 grid_->filter(), space_->grid, time_ - *acquiring_since_, options_.hand_over)) {
    to_cloud();
  }
}

void TargetFilter::to_cloud() {
  NormalDraws draws = cloud_draws(source_.seed, time_, CloudDraw::kHandOver);
  PlaceCloud cloud = cloud_of(grid_->filter(),
                              *space_,
                              grid_->within(),
                              grid_->layers().weights(),
                              options_.cloud.places_at_first,
                              draws);
  cloud_ = std::make_unique<CloudFollower>(
      source_.room,
      CloudFilter(source_.room, options_.cloud, source_.seed, std::move(cloud), time_),
      options_,
      phase_,
      grid_->weighed());
  grid_.reset();
}

void TargetFilter::to_grid() {
  grid_ = std::make_unique<GridFollower>(localizer_, space_, options_, phase_);
  grid_->continue_from(cloud_->cloud(), cloud_->spread(), cloud_->weighed(), time_);
  cloud_.reset();
  acquiring_since_ = time_;
}

}  // namespace rayloc
