// find_time_offset: estimates the clock difference between a survey and its recordings.
//
// Compares the points of a survey with the times at which a device was
// stationary, at every offset at which both overlap. An offset is accepted
// if most points get frames with it, and chance would give clearly fewer.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/site/survey/points_csv.h"
#include "engine/base/timestamp.h"
#include "engine/channel/csi_frame.h"

namespace rayloc {

// The frames of one device at one access point, in any order.
class DeviceTrace {
 public:
  void add(const CsiFrame& frame);

  // Two frames of a stationary device differ by noise, carrier phase and timing only.
  struct Pair {
    Timestamp first;
    Timestamp second;
    double correlation = 0.0;  // between their CSI; 1: the same channel
  };
  const std::vector<Timestamp>& times() const { return times_; }
  const std::vector<Pair>& pairs() const { return pairs_; }

  // Pairs at the first frame's access point, from frames of one device.
  static DeviceTrace of(std::span<const CsiFrame> frames);

 private:
  std::vector<Timestamp> times_;
  std::vector<Pair> pairs_;
  std::optional<CsiFrame> compared_;
};

struct TimeOffset {
  Duration offset{};          // offset added to the times of the points
  std::size_t points = 0;     // points whose windows a stationary device fills with it
  std::size_t as_stated = 0;  // the same count without it
};

// The offset that fits clearly better than the stated times;
// empty if those fit as well, or if no offset is distinct.
std::optional<TimeOffset> find_time_offset(std::span<const SurveyPoint> points,
                                           const DeviceTrace& trace);

// The clock that is off: that of the points, or, if other
// recordings fit the points, that of this recording.
enum class OtherRecordings { kUnknown, kFit };
// "7200.0 s earlier (time zone?): give --time-offset -7200"
std::string describe(const TimeOffset& found, OtherRecordings others);
// "1718000125.389": seconds since 1970, as in a csv of points.
std::string seconds_text(Timestamp time);
// For points without a frame: the time spans of both, and the offset that fits, if any.
std::string explain_other_times(const std::string& points_file,
                                std::span<const SurveyPoint> points,
                                const DeviceTrace& trace,
                                OtherRecordings others = OtherRecordings::kUnknown);

}  // namespace rayloc
