// find_time_offset: by how much the clock of a survey differs from that of its recordings.
//
// The points of a survey are compared with the times at which a device stood still, at every
// offset at which both overlap. An offset counts where most points get frames there, and clearly
// fewer would by chance.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/survey/points_csv.h"
#include "engine/base/timestamp.h"
#include "engine/channel/csi_frame.h"

namespace rayloc::cli {

// The frames of one device at one access point, in any order.
class DeviceTrace {
 public:
  void add(const CsiFrame& frame);

  // Two frames of a device that stands still differ by noise, carrier phase and timing only.
  struct Pair {
    Timestamp first;
    Timestamp second;
    double correlation = 0.0;  // of their CSI; 1: the same channel
  };
  const std::vector<Timestamp>& times() const { return times_; }
  const std::vector<Pair>& pairs() const { return pairs_; }

  // Those of the first frame's access point, of frames of one device.
  static DeviceTrace of(std::span<const CsiFrame> frames);

 private:
  std::vector<Timestamp> times_;
  std::vector<Pair> pairs_;
  std::optional<CsiFrame> compared_;
};

struct TimeOffset {
  Duration offset{};          // to be added to the times of the points
  std::size_t points = 0;     // whose windows a standing device fills with it
  std::size_t as_stated = 0;  // and without it
};

// The offset that fits clearly better than the stated times; nothing where those fit as well, or
// where no offset stands out.
std::optional<TimeOffset> find_time_offset(std::span<const SurveyPoint> points,
                                           const DeviceTrace& trace);

// Whose clock is off: that of the points, or, where other recordings fit the points, that of this
// recording.
enum class OtherRecordings { kUnknown, kFit };
// "7200.0 s earlier (time zone?): give --time-offset -7200"
std::string describe(const TimeOffset& found, OtherRecordings others);
// "1718000125.389": seconds since 1970, as a csv of points has them.
std::string seconds_text(Timestamp time);
// For points without a frame: from when to when both are, and the offset that fits, if any does.
std::string explain_other_times(const std::string& points_file,
                                std::span<const SurveyPoint> points,
                                const DeviceTrace& trace,
                                OtherRecordings others = OtherRecordings::kUnknown);

}  // namespace rayloc::cli
