#include "daemon/messages/gap_detector.h"

#include <iterator>

#include "rayloc/v1/envelope.pb.h"

namespace rayloc {

// Returns the number of messages of the topic lost before this one, and stores its sequence.
std::uint64_t GapDetector::missing_before(const std::string& topic, std::uint64_t sequence) {
  const auto known = last_.find(topic);
  if (known == last_.end()) {
    if (last_.size() >= max_topics_ && !by_age_.empty()) {
      last_.erase(by_age_.front());
      by_age_.pop_front();
    }
    by_age_.push_back(topic);
    last_.emplace(topic, Received{sequence, std::prev(by_age_.end())});
    return 0;
  }
  Received& received = known->second;
  by_age_.splice(by_age_.end(), by_age_, received.age);
  const std::uint64_t lost =
      sequence > received.sequence + 1 ? sequence - received.sequence - 1 : 0;
  received.sequence = sequence;
  return lost;
}

// Compares with the last sequences that a message on `topic` lists.
void GapDetector::compare(const v1::TopicClass& topic_class,
                          const std::string& topic,
                          std::vector<Gap>& gaps) {
  for (const v1::TopicSequence& named : topic_class.last_sequences()) {
    const auto silent = last_.find(named.topic());
    // The message's own topic is not yet counted in its list.
    if (silent != last_.end() && named.topic() != topic &&
        named.sequence() > silent->second.sequence) {
      gaps.push_back({named.topic(), named.sequence() - silent->second.sequence});
      silent->second.sequence = named.sequence();
    }
  }
}

std::vector<GapDetector::Gap> GapDetector::add(const std::string& topic,
                                               const v1::Envelope& envelope) {
  std::vector<Gap> gaps;
  if (any_ && envelope.epoch() != epoch_) {
    ++restarts_;
    last_.clear();
    by_age_.clear();
  }
  any_ = true;
  epoch_ = envelope.epoch();

  if (const std::uint64_t lost = missing_before(topic, envelope.sequence()); lost > 0) {
    gaps.push_back({topic, lost});
  }
  for (const v1::TopicClass& topic_class : envelope.heartbeat().topic_classes()) {
    compare(topic_class, topic, gaps);
  }
  for (const v1::TopicClass& topic_class : envelope.goodbye().topic_classes()) {
    compare(topic_class, topic, gaps);
  }
  for (const Gap& gap : gaps) {
    lost_ += gap.lost;
  }
  return gaps;
}

}  // namespace rayloc
