#include "daemon/messages/last_messages.h"

#include <algorithm>

#include "daemon/messages/topic.h"

namespace rayloc {

void LastMessages::put(const std::string& topic, std::string envelope) {
  const std::lock_guard lock(mutex_);
  auto& [entries, by_age] = sites_[std::string(topic_site(topic))];
  auto found = entries.find(topic);
  if (found == entries.end()) {
    if (entries.size() >= max_topics_ && !by_age.empty()) {
      entries.erase(by_age.front());
      by_age.pop_front();
    }
    by_age.push_back(topic);
    found = entries.emplace(topic, Entry{{}, std::prev(by_age.end())}).first;
  } else {
    by_age.splice(by_age.end(), by_age, found->second.age);
  }
  found->second.envelope = std::move(envelope);
}

std::vector<std::pair<std::string, std::string>> LastMessages::matching(
    const std::vector<std::string>& prefixes) const {
  std::vector<std::pair<std::string, std::string>> found;
  const std::lock_guard lock(mutex_);
  for (const auto& [site, topics] : sites_) {
    for (const auto& [topic, entry] : topics.entries) {
      const std::string& name = topic;
      if (std::any_of(prefixes.begin(), prefixes.end(), [&](const std::string& prefix) {
            return name.compare(0, prefix.size(), prefix) == 0;
          })) {
        found.emplace_back(topic, entry.envelope);
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace rayloc
