#include "daemon/live/service/site/standby_audits.h"

#include <utility>

#include "daemon/live/log/log.h"

namespace rayloc {
namespace {

StandbyAudit::Counters sum(StandbyAudit::Counters one, const StandbyAudit::Counters& other) {
  one.windows += other.windows;
  one.results += other.results;
  one.differing += other.differing;
  one.not_compared += other.not_compared;
  return one;
}

}  // namespace

void StandbyAudits::add(const std::string& site) {
  const std::lock_guard lock(mutex_);
  audits_.try_emplace(site);
}

void StandbyAudits::remove(const std::string& site) {
  const std::lock_guard lock(mutex_);
  audits_.erase(site);
}

void StandbyAudits::note(const std::string& site, const OutStage::Standby& standby) {
  const std::lock_guard lock(mutex_);
  Audit& audit = audits_[site];
  audit.now = standby.counters;
  if (!standby.first_difference.empty() && !std::exchange(audit.is_logged, true)) {
    log_line(LogLevel::kError,
             "site '" + site + "': its owner published other results than this worker computes: " +
                 standby.first_difference +
                 "; `rayloc replay --stream` shows which of the two is wrong");
  }
}

void StandbyAudits::end(const std::string& site) {
  const std::lock_guard lock(mutex_);
  Audit& audit = audits_[site];
  audit = {sum(audit.before, audit.now), {}, false};
}

std::vector<ExtraMetric> StandbyAudits::metrics() const {
  ExtraMetric windows{"rayloc_cluster_standby_windows_total",
                      "Records of owners that were compared with what this worker has computed",
                      true,
                      {}};
  ExtraMetric missed{
      "rayloc_cluster_standby_missed_total",
      "Records of owners that were not compared: not received, or the first after a gap",
      true,
      {}};
  ExtraMetric differing{"rayloc_cluster_divergence_total",
                        "Records of owners that hold other results than this worker has computed",
                        true,
                        {}};
  const std::lock_guard lock(mutex_);
  for (const auto& [name, audit] : audits_) {
    const StandbyAudit::Counters all = sum(audit.before, audit.now);
    windows.samples.push_back({"site", name, static_cast<double>(all.windows)});
    missed.samples.push_back({"site", name, static_cast<double>(all.not_compared)});
    differing.samples.push_back({"site", name, static_cast<double>(all.differing)});
  }
  return {windows, missed, differing};
}

}  // namespace rayloc
