#include "engine/room/preprocess_burst.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/base/median.h"
#include "engine/observe/chain_gains.h"

namespace rayloc {
namespace {

constexpr double kMotionWarning = 0.1;  // a ratio, as Burst::motion_residual; chosen
// [dB], relative to the mean power of the others. With all chains alive, 250 bursts of two rooms
// had none below -18.3; without an antenna, noise and coupling leave -23 or less.
constexpr double kDeadChain = -20.0;
// A ratio, chosen: a silent chain is -120 dB, not minus infinity.
constexpr double kMinShare = 1e-12;

}  // namespace

Expected<void> check_room(const RoomModel* room) {
  if (room == nullptr || room->scene == nullptr) {
    return make_error(ErrorKind::kInternal, "a localizer needs a room with a scene");
  }
  if (!(room->bounds_max.x > room->bounds_min.x && room->bounds_max.y > room->bounds_min.y)) {
    return make_error(ErrorKind::kConfiguration, "the room's bounds are empty");
  }
  if (room->access_points.empty() || room->grid.size() < 2) {
    return make_error(ErrorKind::kConfiguration, "the site has no access point or no tones");
  }
  return {};
}

std::string calibration_problem(const RoomModel& room, const RoomAccessPoint& access_point) {
  const RoomAccessPoint& ap = access_point;
  if (ap.array.element_offset.size() != ap.rx_chains.size() || ap.rx_chains.empty()) {
    return "has " + std::to_string(ap.rx_chains.size()) + " cores for " +
           std::to_string(ap.array.element_offset.size()) + " antennas";
  }
  if (ap.gains.empty()) {
    return "has no chain gains: calibrate the site first (rayloc calibrate)";
  }
  if (ap.gains.grid != room.grid || ap.gains.rx_chains != ap.rx_chains ||
      ap.gains.gain.size() != ap.rx_chains.size() * room.grid.size()) {
    return "was calibrated with other tones or cores: calibrate again";
  }
  return {};
}

std::string no_usable_csi(const RoomModel& room, const std::vector<std::string>& warnings) {
  const auto is_uncalibrated = [](const RoomAccessPoint& ap) { return ap.gains.empty(); };
  if (std::all_of(room.access_points.begin(), room.access_points.end(), is_uncalibrated)) {
    return "no chain gains, calibrate the site";
  }
  return warnings.empty() ? "no access point of the site received the burst" : warnings.front();
}

std::string no_usable_reference_csi(const std::vector<std::string>& warnings) {
  return warnings.empty() ? "no access point of the reference received the burst"
                          : warnings.front();
}

std::optional<BurstObservation> preprocess_burst(const RoomModel& room,
                                                 std::size_t access_point,
                                                 std::span<const CsiFrame> frames,
                                                 const BurstOptions& options,
                                                 std::vector<std::string>& warnings) {
  const RoomAccessPoint& ap = room.access_points[access_point];
  if (std::none_of(frames.begin(), frames.end(), [&](const CsiFrame& frame) {
        return frame.access_point == access_point;
      })) {
    return std::nullopt;
  }
  auto burst = combine_burst(frames, {access_point, room.grid, ap.rx_chains, options});
  if (!burst) {
    warnings.push_back("access point " + ap.id + ": " + burst.error().message);
    return std::nullopt;
  }
  remove_gains(ap.gains, burst->h);
  return *std::move(burst);
}

std::optional<DeadChain> dead_chain(const BurstObservation& burst) {
  if (burst.absent) {
    return DeadChain{burst.absent->row, 10.0 * std::log10(kMinShare), burst.absent};
  }
  const std::size_t rows = burst.rx_chains.size();
  if (rows < 2) {
    return std::nullopt;
  }
  std::vector<double> power(rows);
  for (std::size_t j = 0; j < burst.h.size(); ++j) {
    power[j / burst.grid.size()] += std::norm(burst.h[j]);
  }
  const auto weakest = std::min_element(power.begin(), power.end());
  const double others = std::accumulate(power.begin(), power.end(), -*weakest);
  const double share = *weakest * static_cast<double>(rows - 1) / others;
  const double power_db = 10.0 * std::log10(std::max(share, kMinShare));
  if (!(power_db < kDeadChain)) {
    return std::nullopt;
  }
  return DeadChain{static_cast<std::size_t>(weakest - power.begin()), power_db, {}};
}

std::string dead_chain_text(const RoomAccessPoint& access_point,
                            const BurstObservation& burst,
                            const DeadChain& dead) {
  const std::string rx_chain = std::to_string(burst.rx_chains[dead.row]);
  const std::string begin = "access point " + access_point.id + ": ";
  if (dead.absent && !dead.absent->is_lasting) {  // its datagrams may have been lost
    return begin + "no frame of the burst has core " + rx_chain;
  }
  const std::string how = dead.absent
                              ? "it has no CSI"
                              : std::to_string(std::lround(dead.power_db)) + " dB of the others";
  return begin + "the chain of core " + rx_chain + " is dead (" + how +
         "; check its antenna and pigtail)";
}

BurstObservation without_row(BurstObservation burst, std::size_t row) {
  const auto tones = static_cast<std::ptrdiff_t>(burst.grid.size());
  const auto at = static_cast<std::ptrdiff_t>(row);
  burst.h.erase(burst.h.begin() + at * tones, burst.h.begin() + (at + 1) * tones);
  burst.rx_chains.erase(burst.rx_chains.begin() + at);
  burst.power_dbm.reset();  // the power of the remaining chains was not calibrated
  burst.absent.reset();
  return burst;
}

void ObservationTally::add(const RoomAccessPoint& access_point, const BurstObservation& burst) {
  const bool is_first = snr_db_.empty();
  first_ = is_first ? burst.first : std::min(first_, burst.first);
  last_ = is_first ? burst.last : std::max(last_, burst.last);
  frames_ += burst.frames_used;
  antennas_ += burst.rx_chains.size();
  snr_db_.push_back(burst.snr_db);
  if (burst.motion_residual > kMotionWarning) {
    warnings_.push_back("access point " + access_point.id +
                        ": the channel changes within the burst");
  }
}

void ObservationTally::fill(std::span<const CsiFrame> frames, LocationEstimate& estimate) const {
  estimate.capture_start = frames.front().time;
  estimate.capture_end = frames.back().time;
  const Timestamp first = snr_db_.empty() ? frames.front().time : first_;
  const Timestamp last = snr_db_.empty() ? frames.back().time : last_;
  estimate.time = first + (last - first) / 2;
  estimate.frames_used = frames_;
  estimate.antennas_used = antennas_;
  estimate.access_points_used = snr_db_.size();
  if (!snr_db_.empty()) {
    estimate.snr_db = median(snr_db_);
  }
  estimate.warnings.insert(estimate.warnings.end(), warnings_.begin(), warnings_.end());
}

}  // namespace rayloc
