// StandbyAudits: for a hot standby, the comparisons of its results with those of the owners, by
// site, over all runtimes that a site has had.
//
// Thread safety: any thread.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "daemon/live/cluster/ownership/out_stage.h"
#include "daemon/live/http/metrics.h"

namespace rayloc {

class StandbyAudits {
 public:
  void add(const std::string& site);     // no effect for a site that it has
  void remove(const std::string& site);  // no longer configured
  // Notes the present counters of the site's runtime. Logs the first window that differs, once for
  // each runtime.
  void note(const std::string& site, const OutStage::Standby& standby);
  // The site's runtime compares nothing from now on: its counters are added to those before.
  void end(const std::string& site);

  std::vector<ExtraMetric> metrics() const;

 private:
  // Comparison results of one site so far.
  struct Audit {
    StandbyAudit::Counters before;  // of runtimes that have ended
    StandbyAudit::Counters now;
    bool is_logged = false;  // a difference of the current runtime is logged
  };
  mutable std::mutex mutex_;
  std::map<std::string, Audit> audits_;  // guarded by mutex_; by site
};

}  // namespace rayloc
