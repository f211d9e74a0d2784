#include "daemon/live/publish/sequence_book.h"

#include "daemon/messages/topic.h"

namespace rayloc {

std::uint64_t SequenceBook::next(const std::string& topic) {
  auto found = entries_.find(topic);
  if (found == entries_.end()) {
    if (entries_.size() >= max_topics_ && !by_age_.empty()) {
      recent_.erase(by_age_.front());
      entries_.erase(by_age_.front());
      by_age_.pop_front();
    }
    found = entries_.emplace(topic, Entry{0, by_age_.insert(by_age_.end(), topic)}).first;
  } else {
    by_age_.splice(by_age_.end(), by_age_, found->second.age);
  }
  ++published_[std::string(topic_prefix(topic))];
  recent_.insert(topic);
  return ++found->second.sequence;
}

std::map<std::string, SequenceBook::TopicClass> SequenceBook::classes(bool all) const {
  std::map<std::string, TopicClass> classes;
  for (const auto& [prefix, count] : published_) {
    classes[prefix].published = count;
  }
  for (const auto& [topic, entry] : entries_) {
    if (all || recent_.count(topic) != 0) {
      classes[std::string(topic_prefix(topic))].last[topic] = entry.sequence;
    }
  }
  return classes;
}

std::uint64_t SequenceBook::published() const {
  std::uint64_t sum = 0;
  for (const auto& [prefix, count] : published_) {
    sum += count;
  }
  return sum;
}

}  // namespace rayloc
