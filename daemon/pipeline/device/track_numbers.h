// TrackNumbers: the numbers of the tracks of devices, each used once.
//
// A device has one track at most. A device with a new name is a new track to all subscribers: the
// number would link the names. A successor continues the numbers of its predecessor, and assigns
// none to results that it does not publish.
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

// A plain value: the initial state of a successor's TrackNumbers.
struct NumberedTracks {
  struct Track {
    std::string target;  // name of its device (target_component())
    std::uint64_t number = 0;
  };
  std::uint64_t last = 0;     // last assigned number
  std::vector<Track> tracks;  // not over yet; of one target in the order of their begin
};

class TrackNumbers {
 public:
  TrackNumbers() = default;
  // All results for instants before `done` were published by the predecessor.
  TrackNumbers(NumberedTracks before, Timestamp done)
      : last_(before.last), before_(std::move(before.tracks)), done_(done) {}

  // Number of the device's track at `time`. For results of the predecessor: its number or 0.
  std::uint64_t of(const MacAddress& device, const std::string& target, Timestamp time);
  void lost(const MacAddress& device, Timestamp time);

  // All results before `done` are published: tracks that were lost by then are removed.
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
  std::vector<NumberedTracks::Track> before_;           // the predecessor's, not continued yet
  Timestamp done_ = Timestamp::min();                   // of the predecessor
};

}  // namespace rayloc
