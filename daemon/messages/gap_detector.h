// GapDetector: a subscriber's losses, from the epochs and sequences of its received messages.
//
// Per topic a sequence that skips numbers is a loss in transit. The first message of a topic gives
// no information on earlier ones (a late subscriber), sequence 1 restarts a topic, and a new epoch
// is a restart of the daemon: none is a gap. Heartbeats and the Goodbye list the last sequence
// of topics, so that a loss is detected even on a topic that fell silent.
//
// Memory is bounded: beyond `max_topics` the topic received longest ago is removed, and its next
// message counts as its first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <string>
#include <unordered_map>
#include <vector>

namespace rayloc::v1 {
class Envelope;
class TopicClass;
}  // namespace rayloc::v1

namespace rayloc {

class GapDetector {
 public:
  explicit GapDetector(std::size_t max_topics = 16384) : max_topics_(max_topics) {}

  struct Gap {
    std::string topic;
    std::uint64_t lost = 0;  // messages
  };
  // Returns the losses that `envelope`, received on `topic`, reveals. REQUIRES: order of arrival.
  std::vector<Gap> add(const std::string& topic, const v1::Envelope& envelope);

  std::uint64_t lost() const { return lost_; }
  std::uint64_t restarts() const { return restarts_; }

 private:
  struct Received {
    std::uint64_t sequence = 0;
    std::list<std::string>::iterator age;
  };

  std::uint64_t missing_before(const std::string& topic, std::uint64_t sequence);
  void compare(const v1::TopicClass& topic_class, const std::string& topic, std::vector<Gap>& gaps);

  std::size_t max_topics_;
  std::list<std::string> by_age_;  // received longest ago first
  std::unordered_map<std::string, Received> last_;
  std::uint64_t epoch_ = 0;
  bool any_ = false;
  std::uint64_t lost_ = 0;
  std::uint64_t restarts_ = 0;
};

}  // namespace rayloc
