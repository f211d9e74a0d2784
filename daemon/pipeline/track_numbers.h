// TrackNumbers: the numbers of the tracks of devices, each given once.
//
// A device has one track at most. A device that is called anew is a new track to everyone outside:
// its number would tell. A successor goes on with the numbers that its predecessor gave, and gives
// none for what it says to itself.
//
// Thread safety: for one thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/timestamp.h"
#include "engine/channel/mac_address.h"

namespace rayloc {

// A plain value: what a successor of a TrackNumbers is told.
struct NumberedTracks {
  struct Track {
    std::string target;  // what its device is called (target_component())
    std::uint64_t number = 0;
  };
  std::uint64_t last = 0;     // that was given
  std::vector<Track> tracks;  // that are not over; of one target in the order in which they began
};

class TrackNumbers {
 public:
  TrackNumbers() = default;
  // All that refers to an instant before `done` was said by the predecessor.
  TrackNumbers(NumberedTracks before, Timestamp done)
      : last_(before.last), before_(std::move(before.tracks)), done_(done) {}

  // Of the device's track at `time`. Of what the predecessor has said, its number or 0.
  std::uint64_t of(const MacAddress& device, const std::string& target, Timestamp time);
  void lost(const MacAddress& device, Timestamp time);

  // Everything before `done` has been said: tracks that were lost by then are nobody's any more.
  void advance(Timestamp done);
  // REQUIRES: advance(done).
  NumberedTracks carried() const;

 private:
  struct Numbered {
    NumberedTracks::Track track;
    std::optional<Timestamp> lost;
  };
  std::uint64_t take(const std::string& target);

  std::uint64_t last_ = 0;
  std::map<MacAddress, std::vector<Numbered>> tracks_;  // in the order in which they began
  std::vector<NumberedTracks::Track> before_;           // the predecessor's, not gone on with yet
  Timestamp done_ = Timestamp::min();                   // by the predecessor
};

}  // namespace rayloc
