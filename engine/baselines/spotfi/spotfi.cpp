#include "engine/baselines/spotfi/spotfi.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "engine/base/constants.h"
#include "engine/baselines/paths/turn.h"
#include "engine/baselines/plan_map.h"
#include "engine/room/preprocess_burst.h"

namespace rayloc {
namespace {

constexpr double kMaxWidening = 3.0;  // of sigma, a ratio, chosen: for an unlikely direct path

}  // namespace

// Measurement of one access point.
struct Spotfi::Received {
  std::size_t access_point = 0;
  DirectPath path;
  double sigma = 0.0;     // [rad]
  double outliers = 0.0;  // a share
  PathLossLaw law;
  bool is_power_constant = false;  // the path-loss law gives the distance
};

Spotfi::Spotfi(std::shared_ptr<const RoomModel> room,
               const SpotfiOptions& options,
               std::shared_ptr<const Training> training)
    : room_(std::move(room)),
      options_(options),
      training_(std::move(training)),
      comb_(tone_comb(room_->grid)) {
  for (std::size_t i = 0; i < room_->access_points.size(); ++i) {
    const RoomAccessPoint& ap = room_->access_points[i];
    if (const std::string problem = calibration_problem(*room_, ap); !problem.empty()) {
      warnings_.push_back("access point " + ap.id + " " + problem);
    } else {
      usable_.push_back(i);
    }
  }
}

Expected<Spotfi> Spotfi::create(std::shared_ptr<const RoomModel> room,
                                const SpotfiOptions& options,
                                std::shared_ptr<const Training> training) {
  RAYLOC_TRY(check_room(room.get()));
  if (tone_comb(room->grid).tone.empty()) {
    return make_error(ErrorKind::kConfiguration,
                      "spotfi needs tones in equal steps on both sides of the channel's centre; "
                      "the site's [carrier] has none");
  }
  return Spotfi(std::move(room), options, std::move(training));
}

std::string Spotfi::refusal(std::span<const Received> received) const {
  if (received.size() > 1 || options_.range == SpotfiRange::kRoom ||
      (options_.range == SpotfiRange::kPower && received.front().is_power_constant)) {
    return {};
  }
  return "one access point and no learned level: spotfi has a bearing and no range (add access "
         "points; or declare constant_power, calibrate and train; or --baseline range=room)";
}

// Uses the distances for a device with constant power; otherwise their differences.
double Spotfi::power_log_likelihood(std::span<const Received> received, const Vec3d& place) const {
  const bool is_constant = received.front().is_power_constant;
  double weights = 0.0;
  double mean = 0.0;
  double squares = 0.0;
  for (const Received& one : received) {
    if (!one.path.burst.power_dbm || one.is_power_constant != is_constant) {
      continue;
    }
    const Vec3d& at = room_->access_points[one.access_point].array.pose.position;
    const double off = *one.path.burst.power_dbm - one.law.at(norm(place - at));
    const double weight = 1.0 / (one.law.sigma_db * one.law.sigma_db);
    weights += weight;
    mean += weight * off;
    squares += weight * off * off;
  }
  if (weights == 0.0) {
    return 0.0;
  }
  return -0.5 * (is_constant ? squares : squares - mean * mean / weights);
}

double Spotfi::log_likelihood(std::span<const Received> received, const Vec3d& place) const {
  const double wavelength = kSpeedOfLight / room_->grid.centre_hz;
  double sum = options_.range == SpotfiRange::kNone ? 0.0 : power_log_likelihood(received, place);
  for (const Received& one : received) {
    const AntennaArray& array = room_->access_points[one.access_point].array;
    const double off = wrapped(one.path.psi - psi_of(array, one.path.line, place, wavelength));
    const double x = off / one.sigma;
    const double density = std::exp(-0.5 * x * x) / (one.sigma * std::sqrt(2.0 * std::numbers::pi));
    sum += std::log((1.0 - one.outliers) * density + one.outliers / (2.0 * std::numbers::pi));
  }
  return sum;
}

LocationEstimate Spotfi::locate(std::span<const CsiFrame> frames, std::uint64_t repeat) const {
  LocationEstimate estimate;
  estimate.warnings = warnings_;
  if (frames.empty()) {
    estimate.reason = "no frames";
    return estimate;
  }
  ObservationTally tally;
  std::vector<Received> received;
  double most = 0.0;
  for (const std::size_t i : usable_) {
    const RoomAccessPoint& ap = room_->access_points[i];
    auto path = find_direct_path(
        *room_, i, frames, {comb_, options_.path, options_.seed + repeat}, estimate.warnings);
    if (!path) {
      continue;
    }
    tally.add(ap, path->burst);
    most = std::max(most, path->likelihood);
    Received one{i, *std::move(path), options_.sigma_psi, options_.outliers, {}};
    if (const AccessPointTraining* learned = training_ ? training_->find(ap.id) : nullptr) {
      one.sigma = learned->sigma_psi;
      one.outliers = learned->outliers;
      if (learned->path_loss) {
        const auto& constant = training_->constant_power;
        one.law = *learned->path_loss;
        one.is_power_constant =
            one.path.burst.power_dbm &&
            std::find(constant.begin(), constant.end(), one.path.burst.transmitter) !=
                constant.end();
      }
    }
    received.push_back(std::move(one));
  }
  tally.fill(frames, estimate);
  if (received.empty()) {
    estimate.reason = no_usable_csi(*room_, estimate.warnings);
    return estimate;
  }
  if (estimate.reason = refusal(received); !estimate.reason.empty()) {
    return estimate;
  }
  if (received.size() == 1 && !received.front().is_power_constant) {
    estimate.warnings.emplace_back("one bearing and no range: it ends at the walls of the room");
  }
  for (Received& one : received) {
    one.sigma *= std::min(kMaxWidening, std::sqrt(most / one.path.likelihood));
  }
  summarise_plan(
      *room_,
      {options_.grid, options_.accuracy_confidence},
      [&](const Vec3d& place) { return log_likelihood(received, place); },
      estimate);
  return estimate;
}

}  // namespace rayloc
