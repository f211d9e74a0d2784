#include "daemon/publish/last_messages.h"

#include <algorithm>

namespace rayloc {

void LastMessages::put(const std::string& topic, std::string envelope) {
  const std::lock_guard lock(mutex_);
  auto found = entries_.find(topic);
  if (found == entries_.end()) {
    if (entries_.size() >= max_topics_ && !by_age_.empty()) {
      entries_.erase(by_age_.front());
      by_age_.pop_front();
    }
    by_age_.push_back(topic);
    found = entries_.emplace(topic, Entry{{}, std::prev(by_age_.end())}).first;
  } else {
    by_age_.splice(by_age_.end(), by_age_, found->second.age);
  }
  found->second.envelope = std::move(envelope);
}

std::vector<std::pair<std::string, std::string>> LastMessages::matching(
    const std::vector<std::string>& prefixes) const {
  std::vector<std::pair<std::string, std::string>> found;
  const std::lock_guard lock(mutex_);
  for (const auto& [topic, entry] : entries_) {
    const std::string& name = topic;
    if (std::any_of(prefixes.begin(), prefixes.end(), [&](const std::string& prefix) {
          return name.compare(0, prefix.size(), prefix) == 0;
        })) {
      found.emplace_back(topic, entry.envelope);
    }
  }
  return found;
}

}  // namespace rayloc
