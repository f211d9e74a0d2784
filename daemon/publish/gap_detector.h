// GapDetector: what a subscriber has lost, from the epochs and sequences of what it got.
//
// Per topic a sequence that skips numbers is a loss on the way. The first message of a topic tells
// nothing of what was before it (a late subscriber), sequence 1 begins a topic anew, and a new
// epoch is a restart of the daemon: neither is a gap. Heartbeats and the Goodbye name the last
// sequence of topics, so that a loss shows even on a topic that fell silent.
//
// Memory is bounded: past `max_topics` the topic that was heard longest ago is forgotten, and tells
// nothing when it is heard again.
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
  // What `envelope`, received on `topic`, shows to be lost. REQUIRES: order of arrival.
  std::vector<Gap> add(const std::string& topic, const v1::Envelope& envelope);

  std::uint64_t lost() const { return lost_; }
  std::uint64_t restarts() const { return restarts_; }

 private:
  struct Heard {
    std::uint64_t sequence = 0;
    std::list<std::string>::iterator age;
  };

  std::uint64_t missing_before(const std::string& topic, std::uint64_t sequence);
  void compare(const v1::TopicClass& topic_class, const std::string& topic, std::vector<Gap>& gaps);

  std::size_t max_topics_;
  std::list<std::string> by_age_;  // heard longest ago first
  std::unordered_map<std::string, Heard> last_;
  std::uint64_t epoch_ = 0;
  bool any_ = false;
  std::uint64_t lost_ = 0;
  std::uint64_t restarts_ = 0;
};

}  // namespace rayloc
