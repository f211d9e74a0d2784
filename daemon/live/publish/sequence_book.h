// SequenceBook: the last sequence number of each topic, and the message counts of topic classes.
//
// Memory is bounded: beyond `max_topics` the topic published longest ago is removed and would
// restart at 1, which subscribers treat as a new beginning (envelope.proto, `sequence`).
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <set>
#include <string>
#include <unordered_map>

namespace rayloc {

class SequenceBook {
 public:
  explicit SequenceBook(std::size_t max_topics) : max_topics_(max_topics) {}

  // The sequence number of the topic's next message, from 1.
  std::uint64_t next(const std::string& topic);

  struct TopicClass {
    std::uint64_t published = 0;
    std::map<std::string, std::uint64_t> last;  // sequence by topic
  };
  // By prefix "v1/CLASS/SITE/". `last` holds the topics that were published since the last call of
  // forget_recent(), or with `all` every stored topic.
  std::map<std::string, TopicClass> classes(bool all) const;
  void forget_recent() { recent_.clear(); }

  std::uint64_t published() const;

 private:
  struct Entry {
    std::uint64_t sequence = 0;
    std::list<std::string>::iterator age;
  };

  std::size_t max_topics_;
  std::list<std::string> by_age_;  // longest unused first
  std::unordered_map<std::string, Entry> entries_;
  std::map<std::string, std::uint64_t> published_;  // by prefix
  std::set<std::string> recent_;
};

}  // namespace rayloc
