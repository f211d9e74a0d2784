// SiteSet: the running sites, by name, and those that are configured but do not run. HTTP handlers
// read it while a reload changes it.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "daemon/live/live_map/background_text.h"
#include "daemon/live/publish/message_board.h"
#include "daemon/live/service/http_api.h"
#include "daemon/live/service/site/input_files.h"
#include "daemon/live/service/site/site_runtime.h"

namespace rayloc {

struct RunningSite {
  std::shared_ptr<MessageBoard> board;  // null without HTTP; outlives a reload of the site
  std::shared_ptr<SiteOutput> output;
  std::shared_ptr<SiteRuntime> runtime;  // writes to its output, which reads from it
  InputFiles files;                      // content at the time of its preparation
  // Of that same runtime; null without HTTP.
  std::shared_ptr<const SiteApi> api;
  std::shared_ptr<BackgroundText> channel;
  std::string trouble;     // reason why the last reload failed; otherwise empty
  bool has_ended = false;  // the last reload ended it, and could not start it again

  const std::string& name() const { return runtime->setup().site.name; }
  std::string label() const { return runtime->setup().label(); }
};

// Thread safety: any thread; the result of all() stays unchanged while it is held.
class SiteSet {
 public:
  using Site = std::shared_ptr<const RunningSite>;

  std::vector<Site> all() const {
    const std::lock_guard lock(mutex_);
    return sites_;
  }
  Site find(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    const auto found = place_of(name);
    return found == sites_.end() ? nullptr : *found;
  }
  // Sites of the configuration that have never started, with the reason, by name.
  using Absent = std::map<std::string, std::string>;
  Absent absent() const {
    const std::lock_guard lock(mutex_);
    return absent_;
  }
  void put_absent(const std::string& name, const std::string& why) {
    const std::lock_guard lock(mutex_);
    absent_[name] = why;
  }
  // Replaces the site of that name, otherwise appends it.
  void put(RunningSite site) {
    auto shared = std::make_shared<const RunningSite>(std::move(site));
    const std::lock_guard lock(mutex_);
    absent_.erase(shared->name());
    const auto found = place_of(shared->name());
    if (found == sites_.end()) {
      sites_.push_back(std::move(shared));
    } else {
      sites_[static_cast<std::size_t>(found - sites_.begin())] = std::move(shared);
    }
  }
  void remove(const std::string& name) {
    const std::lock_guard lock(mutex_);
    absent_.erase(name);
    std::erase_if(sites_, [&](const Site& one) { return one->name() == name; });
  }

 private:
  std::vector<Site>::const_iterator place_of(const std::string& name) const {
    return std::find_if(
        sites_.begin(), sites_.end(), [&](const Site& one) { return one->name() == name; });
  }

  mutable std::mutex mutex_;
  std::vector<Site> sites_;  // guarded by mutex_; in the order of the configuration, then of time
  Absent absent_;            // guarded by mutex_
};

}  // namespace rayloc
