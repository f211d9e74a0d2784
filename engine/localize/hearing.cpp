#include "engine/localize/hearing.h"

#include <algorithm>
#include <utility>

#include "engine/observe/chain_gains.h"

namespace rayloc {
namespace {

constexpr double kMotionWarning = 0.1;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::string calibration_problem(const RoomModel& room, const RoomAccessPoint& access_point) {
  const RoomAccessPoint& ap = access_point;
  if (ap.array.element_offset.size() != ap.cores.size() || ap.cores.empty()) {
    return "has " + std::to_string(ap.cores.size()) + " cores for " +
           std::to_string(ap.array.element_offset.size()) + " antennas";
  }
  if (ap.gains.empty()) {
    return "has no chain gains: calibrate the site first (rayloc calibrate)";
  }
  if (ap.gains.grid != room.grid || ap.gains.cores != ap.cores ||
      ap.gains.gain.size() != ap.cores.size() * room.grid.size()) {
    return "was calibrated with other tones or cores: calibrate again";
  }
  return {};
}

std::optional<BurstObservation> hear(const RoomModel& room,
                                     std::size_t access_point,
                                     std::span<const CsiFrame> frames,
                                     const BurstOptions& options,
                                     std::vector<std::string>& warnings) {
  const RoomAccessPoint& ap = room.access_points[access_point];
  const auto index = static_cast<int>(access_point);
  if (std::none_of(frames.begin(), frames.end(), [&](const CsiFrame& frame) {
        return frame.access_point == index;
      })) {
    return std::nullopt;
  }
  auto burst = combine_burst(frames, {index, room.grid, ap.cores, options});
  if (!burst) {
    warnings.push_back("access point " + ap.id + ": " + burst.error().message);
    return std::nullopt;
  }
  remove_gains(ap.gains, burst->h);
  return *std::move(burst);
}

void HearingTally::add(const RoomAccessPoint& access_point, const BurstObservation& burst) {
  const bool is_first = snr_db_.empty();
  first_ = is_first ? burst.first : std::min(first_, burst.first);
  last_ = is_first ? burst.last : std::max(last_, burst.last);
  frames_ += burst.frames_used;
  antennas_ += burst.cores.size();
  snr_db_.push_back(burst.snr_db);
  if (burst.motion_residual > kMotionWarning) {
    warnings_.push_back("access point " + access_point.id +
                        ": the channel changes within the burst");
  }
}

void HearingTally::fill(std::span<const CsiFrame> frames, LocationEstimate& estimate) const {
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
