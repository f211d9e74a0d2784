#include "daemon/lab/predict/planned_room.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "daemon/site/model/room_model.h"
#include "engine/channel/tone_plan.h"

namespace rayloc {
namespace {

// Residual errors of calibrations, measured: medians of 16 access points in 8 calibrated sites of 4
// simulated rooms (143 or 195 points); the exponent and the least sigma of the sites.
constexpr ModelError kCalibrated{
    .plan_tolerance = 0.0015,  // [m]
    .diffuse = 0.072,          // share of the traced power at 3 m
    .diffuse_exponent = 0.12,  // power of the distance
    .diffuse_decay = 10.9e-9,  // [s]
    .noise = 2.4e-4,           // share of the power
};
constexpr double kCalibratedExponent = 0.8;     // of the likelihood, a power, measured as above
constexpr double kCalibratedSigmaFloor = 1e-3;  // [m], measured as above
constexpr double kRowTolerance = 1e-3;          // [m], chosen: straightness of a row
// For rays after a calibration (JointCalibrationOptions::use).
constexpr TraceOptions kCalibratedRays{.max_depth = 3, .transmission = true};

Expected<void> keep_only(const std::vector<std::string>& ids, RoomModel& room) {
  if (ids.empty()) {
    return {};
  }
  std::vector<RoomAccessPoint> kept;
  for (const std::string& id : ids) {
    const auto found = std::find_if(room.access_points.begin(),
                                    room.access_points.end(),
                                    [&](const RoomAccessPoint& one) { return one.id == id; });
    if (found == room.access_points.end()) {
      return make_error(ErrorKind::kUsage, "--access-points: the site has no '" + id + "'");
    }
    // The same one twice would count as two with independent errors: too good a prediction.
    if (std::any_of(kept.begin(), kept.end(), [&](const auto& one) { return one.id == id; })) {
      return make_error(ErrorKind::kUsage, "--access-points: '" + id + "' is named twice");
    }
    kept.push_back(*found);
  }
  room.access_points = std::move(kept);
  return {};
}

// A single antenna has no distance to another, and is unchanged.
Expected<void> set_spacing(double spacing, RoomModel& room) {
  bool has_row = false;
  for (RoomAccessPoint& ap : room.access_points) {
    if (ap.array.element_offset.size() < 2) {
      continue;
    }
    std::vector<double> gaps = gaps_of(ap.array);
    if (gaps.empty()) {
      return make_error(ErrorKind::kUsage,
                        "--spacing: the antennas of '" + ap.id +
                            "' are no row; state their positions in site.toml instead");
    }
    std::fill(gaps.begin(), gaps.end(), spacing);
    set_gaps(ap.array, gaps);
    has_row = true;
  }
  if (!has_row) {
    return make_error(ErrorKind::kUsage, "--spacing: no access point has several antennas");
  }
  return {};
}

// All tones that frames of that bandwidth measure, except those at the centre.
OfdmGrid grid_of(double centre_hz, int bandwidth_mhz) {
  const TonePlan& plan = tone_plan(PhyFormat::kVht, bandwidth_mhz);
  return {centre_hz, plan.spacing_hz, plan.active};
}

ChainGains without_gains(const RoomAccessPoint& access_point, const OfdmGrid& grid) {
  ChainGains gains;
  gains.grid = grid;
  gains.rx_chains = access_point.rx_chains;
  gains.gain.assign(access_point.rx_chains.size() * grid.size(), 1.0);
  return gains;
}

}  // namespace

Expected<RoomModel> planned_room(const Site& site, const PlannedRoomOptions& plan) {
  auto room = load_room_model(site);
  if (!room) {
    return room;
  }
  RAYLOC_TRY(keep_only(plan.access_points, *room));
  const bool other_tones =
      plan.bandwidth_mhz != 0 && plan.bandwidth_mhz != site.carrier.bandwidth_mhz;
  if (other_tones) {
    room->grid = grid_of(room->grid.centre_hz, plan.bandwidth_mhz);
  }
  if (!site.calibration_file) {
    room->trace = kCalibratedRays;
    room->likelihood_exponent = kCalibratedExponent;
    room->sigma_floor = kCalibratedSigmaFloor;
  }
  for (RoomAccessPoint& ap : room->access_points) {
    if (ap.gains.empty()) {
      ap.error = kCalibrated;
    }
    if (ap.gains.empty() || other_tones) {
      ap.gains = without_gains(ap, room->grid);
    }
    ap.powers.clear();
  }
  if (plan.spacing) {
    RAYLOC_TRY(set_spacing(*plan.spacing, *room));
  }
  return room;
}

std::vector<double> gaps_of(const AntennaArray& array) {
  const auto& offsets = array.element_offset;
  if (offsets.size() < 2) {
    return {};
  }
  const Vec3d whole = offsets.back() - offsets.front();
  if (!(norm(whole) > kRowTolerance)) {
    return {};
  }
  const Vec3d along = normalized(whole);
  std::vector<double> gaps;
  for (std::size_t i = 1; i < offsets.size(); ++i) {
    const Vec3d step = offsets[i] - offsets[i - 1];
    const double gap = dot(step, along);
    if (gap <= 0.0 || norm(step - gap * along) > kRowTolerance) {
      return {};
    }
    gaps.push_back(gap);
  }
  return gaps;
}

void set_gaps(AntennaArray& array, const std::vector<double>& gaps) {
  const std::vector<double> before = gaps_of(array);
  if (before.empty() || before.size() != gaps.size()) {
    return;
  }
  auto& offsets = array.element_offset;
  const Vec3d along = normalized(offsets.back() - offsets.front());
  const Vec3d middle = 0.5 * (offsets.front() + offsets.back());
  double whole = 0.0;
  for (const double gap : gaps) {
    whole += gap;
  }
  double at = -0.5 * whole;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    offsets[i] = middle + at * along;
    at += i < gaps.size() ? gaps[i] : 0.0;
  }
}

}  // namespace rayloc
