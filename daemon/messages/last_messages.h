// LastMessages: the last message of each topic, for late subscribers (snapshots, the HTTP API).
//
// Memory is bounded: beyond `max_topics` of a site its topic published longest ago is removed;
// a site with many topics displaces none of another. Thread safety: all members from any
// thread.
#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace rayloc {

class LastMessages {
 public:
  explicit LastMessages(std::size_t max_topics) : max_topics_(max_topics) {}

  // `envelope`: a serialised v1::Envelope.
  void put(const std::string& topic, std::string envelope);

  // Topic and envelope of each topic that begins with one of the prefixes, in alphabetical order.
  std::vector<std::pair<std::string, std::string>> matching(
      const std::vector<std::string>& prefixes) const;

 private:
  struct Entry {
    std::string envelope;
    std::list<std::string>::iterator age;
  };
  struct OfSite {
    std::map<std::string, Entry> entries;
    std::list<std::string> by_age;  // longest unused first
  };
  const std::size_t max_topics_;
  mutable std::mutex mutex_;
  std::map<std::string, OfSite, std::less<>> sites_;  // guarded by mutex_
};

}  // namespace rayloc
