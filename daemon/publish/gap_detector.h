// GapDetector: what a subscriber has lost, from the epochs and sequences of what it got.
//
// Per topic a sequence that skips numbers is a loss on the way. The first message of a topic tells
// nothing of what was before it (a late subscriber), sequence 1 begins a topic anew, and a new
// epoch is a restart of the daemon: neither is a gap. Heartbeats name the last sequence of the
// topics that were busy, so that a loss shows even on a topic that fell silent.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

namespace rayloc::v1 {
class Envelope;
}  // namespace rayloc::v1

namespace rayloc {

class GapDetector {
 public:
  struct Gap {
    std::string topic;
    std::uint64_t lost = 0;  // messages
  };
  // What `envelope`, received on `topic`, shows to be lost. REQUIRES: order of arrival.
  std::vector<Gap> add(const std::string& topic, const v1::Envelope& envelope);

  std::uint64_t lost() const { return lost_; }
  std::uint64_t restarts() const { return restarts_; }

 private:
  std::unordered_map<std::string, std::uint64_t> last_;
  std::uint64_t epoch_ = 0;
  bool any_ = false;
  std::uint64_t lost_ = 0;
  std::uint64_t restarts_ = 0;
};

}  // namespace rayloc
