#include "engine/track/cloud_filter.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/base/check.h"

namespace rayloc {
namespace {

// Largest odds that the target is at one of the places, chosen: a later contradiction counts.
constexpr double kMaxOdds = 1e4;

HeightPrior height_of(const Grid& grid) {
  return {grid.first.z, grid.layers.is_known() ? 0.0 : grid.height_sigma};
}

}  // namespace

NormalDraws cloud_draws(std::uint64_t seed, Timestamp time, CloudDraw purpose) {
  const auto nanoseconds = static_cast<std::uint64_t>(time.time_since_epoch().count());
  return NormalDraws(mixed(seed ^ mixed(nanoseconds) ^ static_cast<std::uint64_t>(purpose)));
}

CloudFilter::CloudFilter(std::shared_ptr<const CloudRoom> room,
                         const CloudOptions& options,
                         std::uint64_t seed,
                         PlaceCloud cloud,
                         Timestamp time,
                         CloudEvidence::Compare compare)
    : room_(std::move(room)),
      options_(options),
      seed_(seed),
      cloud_(std::move(cloud)),
      time_(time),
      evidence_(room_, std::move(compare)),
      log_odds_(std::log(kMaxOdds)) {}

bool CloudFilter::is_due(std::span<const CsiFrame> frames) const {
  if (frames.empty() || frames.front().time - noted_ >= options_.moment_of_one) {
    return true;
  }
  const std::size_t sender = frames.front().access_point;
  const bool is_of_one = std::all_of(frames.begin(), frames.end(), [&](const CsiFrame& frame) {
    return frame.access_point == sender;
  });
  return !is_of_one || std::find(senders_.begin(), senders_.end(), sender) == senders_.end();
}

void CloudFilter::note(std::span<const CsiFrame> frames) {
  senders_.clear();
  for (const CsiFrame& frame : frames) {
    if (std::find(senders_.begin(), senders_.end(), frame.access_point) == senders_.end()) {
      senders_.push_back(frame.access_point);
    }
    noted_ = frame.time;
  }
}

void CloudFilter::advance(Timestamp time) {
  RAYLOC_CHECK(time >= time_);
  const Grid& grid = room_->lattice.grid();
  const std::size_t outside = grid.size();
  std::vector<std::size_t> before(cloud_.size());
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    before[i] = cell_of(cloud_, i, grid);
  }
  NormalDraws draws = cloud_draws(seed_, time, CloudDraw::kPredict);
  cloud_.predict(to_seconds(time - time_), options_.motion, height_of(grid), draws);
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    const std::size_t now = cell_of(cloud_, i, grid);
    const bool stays = now == before[i] && now != outside;
    if (!stays &&
        (now == outside || before[i] == outside || !is_open(*room_->space, before[i], now))) {
      cloud_.remove(i);
    }
  }
  time_ = time;
}

void CloudFilter::rest(Timestamp time) {
  RAYLOC_CHECK(time >= time_);
  time_ = time;
}

bool CloudFilter::weigh(const RoomObservation& observation, double weight) {
  std::vector<std::uint32_t> boxes(cloud_.size(), BoxLattice::kNone);
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    if (cloud_.log_weight()[i] > PlaceCloud::kNoWeight) {
      boxes[i] = room_->lattice.box_at(cloud_.x()[i], cloud_.y()[i], cloud_.z()[i]);
    }
  }
  const std::optional<CloudEvidence::Weights> weights =
      evidence_.weigh(observation, cloud_, boxes, weight);
  if (!weights) {
    return false;
  }
  const double log_mean = cloud_.weigh(weights->factor);
  if (!std::isfinite(log_mean)) {
    return false;
  }
  log_odds_ = std::min(std::log(kMaxOdds), log_odds_ + log_mean);
  loss_ = -static_cast<double>(weights->best);
  is_alone_ = observation.arrays.size() == 1;
  return true;
}

std::size_t CloudFilter::next_count() const {
  const std::size_t least = is_alone_ ? options_.places_of_one : options_.places_of_more;
  return std::max(least, 2 * cloud_.size() / 3);
}

void CloudFilter::thin() {
  const std::size_t count = next_count();
  const double least = options_.least_effective * static_cast<double>(cloud_.size());
  if (cloud_.size() <= count && cloud_.effective() >= least) {
    return;
  }
  NormalDraws draws = cloud_draws(seed_, time_, CloudDraw::kThin);
  cloud_.resample(count, options_.motion, room_->lattice.is_height_known(), draws);
}

double CloudFilter::away() const { return 1.0 / (1.0 + std::exp(log_odds_)); }

double CloudFilter::summarise(PosteriorOptions options, LocationEstimate& location) const {
  options.outlier = 1.0 - (1.0 - away()) * (1.0 - options.outlier);
  const double outside = summarise_cloud(
      cloud_, room_->lattice.grid(), room_->localizer->area().inside, options, location);
  location.loss = loss_;
  return outside;
}

double CloudFilter::velocity_variance() const {
  const std::vector<float> weights = cloud_.weights();
  double u = 0.0;
  double v = 0.0;
  double square = 0.0;  // of both components together
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    const CloudPlace place = cloud_.place(i);
    const auto weight = static_cast<double>(weights[i]);
    const auto of_u = static_cast<double>(place.u);
    const auto of_v = static_cast<double>(place.v);
    u += weight * of_u;
    v += weight * of_v;
    square += weight * (of_u * of_u + of_v * of_v + 2.0 * static_cast<double>(place.variance));
  }
  return std::max(0.0, 0.5 * (square - u * u - v * v));
}

}  // namespace rayloc
