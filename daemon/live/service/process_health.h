// ProcessHealth: the state of raylocd that its sites share: the configuration in effect, the last
// reload and the threads that make no progress.
//
// Thread safety: any thread.
#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "daemon/live/config/config.h"
#include "daemon/live/health/readiness.h"
#include "daemon/live/http/metrics.h"
#include "engine/base/timestamp.h"

namespace rayloc {

class ProcessHealth {
 public:
  // `values`: null if the configuration stays as it was. `now`: time of the reload.
  void note_reload(bool successful, const ConfigValues* values, Timestamp now);
  void note_stuck(std::vector<std::string> stages);

  std::vector<std::string> stuck_stages() const;
  std::string config_json() const;  // every key in effect
  bool reload_failed() const;       // the last one

  // Adds the state to that of one site. `label`: the site's, with several sites; stages of other
  // sites are left out. Empty: the only site.
  void fill(ServiceHealth& health, const std::string& label) const;
  std::vector<ExtraMetric> metrics() const;

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> stuck_stages_;  // guarded by mutex_
  std::string config_json_;                // guarded by mutex_
  bool reload_failed_ = false;             // guarded by mutex_
  Timestamp reloaded_{};                   // guarded by mutex_; time of the last reload
};

}  // namespace rayloc
