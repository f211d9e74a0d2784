#include "daemon/live/log/limited_log.h"

#include <utility>

namespace rayloc {

void LimitedLog::add(const std::string& site, LogEvent event, std::uint64_t times, Time now) {
  const std::lock_guard lock(mutex_);
  const auto found = sites_.find(site);
  if (found == sites_.end()) {
    write_(event);
    sites_.emplace(site, Site{now, 0, std::move(event)});
    return;
  }
  found->second.held_back += times;
  found->second.latest = std::move(event);
  if (now - found->second.logged >= period_) {
    write(found->second, now);
  }
}

void LimitedLog::flush(Time now) {
  const std::lock_guard lock(mutex_);
  for (auto& [name, site] : sites_) {
    if (site.held_back > 0 && now - site.logged >= period_) {
      write(site, now);
    }
  }
}

void LimitedLog::finish() {
  const std::lock_guard lock(mutex_);
  for (auto& [name, site] : sites_) {
    if (site.held_back > 0) {
      write(site, site.logged);
    }
  }
}

void LimitedLog::write(Site& site, Time now) {
  LogEvent event = site.latest;
  event.fields.push_back({"times", std::to_string(site.held_back)});
  write_(event);
  site.logged = now;
  site.held_back = 0;
}

}  // namespace rayloc
