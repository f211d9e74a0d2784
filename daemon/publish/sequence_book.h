// SequenceBook: the last sequence number of each topic, and what was published per class of topics.
//
// Memory is bounded: past `max_topics` the topic that was published longest ago is forgotten and
// would begin at 1 again, which subscribers take for what it is (envelope.proto, `sequence`).
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
  // forget_recent(), or with `all` every topic that is remembered.
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
