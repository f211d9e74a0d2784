#include "daemon/publish/gap_detector.h"

#include "rayloc/v1/envelope.pb.h"

namespace rayloc {

std::vector<GapDetector::Gap> GapDetector::add(const std::string& topic,
                                               const v1::Envelope& envelope) {
  std::vector<Gap> gaps;
  if (any_ && envelope.epoch() != epoch_) {
    ++restarts_;
    last_.clear();
  }
  any_ = true;
  epoch_ = envelope.epoch();

  const auto [known, is_new] = last_.try_emplace(topic, envelope.sequence());
  if (!is_new) {
    if (envelope.sequence() > known->second + 1) {
      gaps.push_back({topic, envelope.sequence() - known->second - 1});
    }
    known->second = envelope.sequence();
  }
  for (const v1::TopicClass& topic_class : envelope.heartbeat().topic_classes()) {
    for (const v1::TopicSequence& last : topic_class.last_sequences()) {
      const auto silent = last_.find(last.topic());
      // The heartbeat's own topic is not yet counted in what the heartbeat says.
      if (silent != last_.end() && last.topic() != topic && last.sequence() > silent->second) {
        gaps.push_back({last.topic(), last.sequence() - silent->second});
        silent->second = last.sequence();
      }
    }
  }
  for (const Gap& gap : gaps) {
    lost_ += gap.lost;
  }
  return gaps;
}

}  // namespace rayloc
