#include "daemon/live/cluster/operate/worker_check.h"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>

#include <fmt/format.h>

#include "engine/base/printable.h"

namespace rayloc {
namespace {

constexpr double kMaxClockOffset = 0.1;  // s: above the transit time of a message

Finding check_worker(const ClusterView::Worker& worker) {
  const v1::WorkerState& state = worker.state;
  const std::string what =
      fmt::format("worker {}: {} sites", printable(state.worker()), state.sites_size());
  const Timestamp reported{std::chrono::microseconds(state.now_us())};
  const double apart = to_seconds(worker.received - reported);
  if (state.now_us() != 0 && std::abs(apart) > kMaxClockOffset) {
    return Finding::warning(fmt::format("{}: its clock is {:.2f} s {} the clock of this host",
                                        what,
                                        std::abs(apart),
                                        apart > 0 ? "behind" : "ahead of"),
                            "synchronize both with NTP");
  }
  if (state.shedding() > 0) {
    return Finding::warning(
        fmt::format("{}, overloaded: it skips windows of {} of them", what, state.shedding()),
        "add a worker, or reduce its capacity");
  }
  if (state.leaving()) {
    return Finding::warning(what + ", it is leaving and accepts no sites", "restart it when ready");
  }
  if (state.capacity() > 0 && static_cast<std::uint32_t>(state.sites_size()) >= state.capacity()) {
    return Finding::warning(what + ", its capacity is reached",
                            "increase capacity, or add a worker");
  }
  return Finding::ok(what);
}

}  // namespace

std::vector<Finding> check_workers(const ClusterView& view) {
  std::vector<Finding> findings;
  std::set<std::string> arithmetic;
  std::set<std::uint32_t> leases;
  for (const auto& [name, worker] : view.workers) {
    findings.push_back(check_worker(worker));
    arithmetic.insert(worker.state.arithmetic());
    leases.insert(worker.state.lease_ms());
  }
  if (view.workers.empty()) {
    findings.push_back(Finding::problem("no worker reports", "start a raylocd with role worker"));
  }
  if (arithmetic.size() > 1) {
    findings.push_back(
        Finding::warning("workers use different instruction sets (`rayloc cluster status`)",
                         "after a takeover, results differ in their last digits"));
  }
  if (leases.size() > 1) {
    findings.push_back(
        Finding::problem("workers have different leases", "set the same lease_s on all workers"));
  }
  return findings;
}

std::vector<Finding> check_owners(const ClusterView& view) {
  std::vector<Finding> findings;
  for (const auto& [name, site] : view.sites) {
    findings.push_back(
        view.has_owner(site.claim)
            ? Finding::ok("site " + printable(name) + ": worker " + printable(site.claim.worker()))
            : Finding::problem("site " + printable(name) + " has no worker",
                               "start a worker that has this [[site]] and free capacity"));
  }
  return findings;
}

}  // namespace rayloc
