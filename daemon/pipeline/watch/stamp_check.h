// Time stamps that do not advance: one stamp for a whole recording, or whole seconds. Frames that
// share a stamp are one burst, regardless of the device's motion: they give no position.
//
// One transmitter cannot send kStuckFrames frames within a microsecond. Fewer frames of one stamp
// are usual: recorders read and stamp datagrams together.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "capture/transport/datagram.h"
#include "engine/base/timestamp.h"
#include "engine/channel/csi_frame.h"
#include "engine/channel/mac_address.h"

namespace rayloc {

inline constexpr std::size_t kStuckFrames = 16;
inline constexpr std::size_t kFramesOfASecond = 3;  // with a stamp of a whole second

struct StuckStamp {
  std::size_t access_point = 0;
  Timestamp time;
  std::size_t frames = 0;                                   // that share it
  bool is_stuck() const { return frames >= kStuckFrames; }  // otherwise of a whole second
};

// Among the frames of one transmitter, those of one access point that share a stamp; empty if no
// stamp is wrong.
std::optional<StuckStamp> stuck_stamp(std::span<const CsiFrame> frames);
// "time stamps do not advance"; the same for every burst of a recording.
std::string describe(const StuckStamp& stamp);

// Checks the records and frames of one source.
class StampTally {
 public:
  // In the order of arrival.
  void add(std::span<const Datagram> datagrams);
  void add(std::span<const CsiFrame> frames);

  // "90 of 178 records share the time stamp ...", with the consequence; empty if there is no
  // fault.
  std::string text() const;

 private:
  std::size_t records_ = 0;
  std::size_t run_ = 0;  // of records with the last stamp
  std::size_t longest_run_ = 0;
  Timestamp record_;
  Timestamp frame_;                             // last stamp
  std::map<MacAddress, std::size_t> of_stamp_;  // frames with it, by transmitter
  StuckStamp worst_;                            // of the frames
  std::size_t whole_seconds_ = 0;               // stamps with kFramesOfASecond frames
  std::size_t stamps_ = 0;
};

}  // namespace rayloc
