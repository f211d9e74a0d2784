#include "daemon/cli/verbs/report/cluster_report.h"

#include <chrono>
#include <cstdint>

#include <fmt/format.h>

#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

std::string worker_text(const std::string& name, const v1::WorkerState& state) {
  constexpr std::uint32_t kPermillePerPercent = 10;
  std::string text =
      fmt::format("worker {}: {} sites{}{}{}, load {} %, arithmetic {}\n",
                  printable(name),
                  state.sites_size(),
                  state.capacity() > 0 ? fmt::format(" of at most {}", state.capacity()) : "",
                  state.leaving() ? ", gives them back" : "",
                  state.shedding() > 0 ? fmt::format(", behind with {}", state.shedding()) : "",
                  state.load_permille() / kPermillePerPercent,
                  printable(state.arithmetic()));
  for (const v1::StandbyState& one : state.stands_by()) {
    text += fmt::format("  hot for {}: audit: {} windows compared, {} differ ({} results{})\n",
                        printable(one.site()),
                        one.windows(),
                        one.differing(),
                        one.results(),
                        one.is_late() ? "; begun later than the owner: no positions" : "");
  }
  return text;
}

std::string owner_text(const ClusterView& view, const v1::SiteClaim& claim) {
  if (claim.worker().empty()) {
    return "no worker has it";
  }
  return "worker " + printable(claim.worker()) + (view.has_owner(claim) ? "" : " is silent");
}

std::string lag_text(const v1::OutputRecord& last, Timestamp now) {
  const std::int64_t done = last.has_output() ? last.output().done_us() : last.begin().done_us();
  return done == 0 ? "no results yet"
                   : fmt::format("results complete up to {:.1f} s ago",
                                 to_seconds(now - Timestamp(std::chrono::microseconds(done))));
}

}  // namespace

std::string workers_text(const ClusterView& view) {
  std::string text;
  for (const auto& [name, worker] : view.workers) {
    text += worker_text(name, worker.state);
  }
  return text + fmt::format("{} workers, {} sites, {} without a worker\n",
                            view.workers.size(),
                            view.sites.size(),
                            view.sites_without_owner());
}

std::string sites_text(const ClusterView& view, Timestamp now) {
  std::string text;
  for (const auto& [name, site] : view.sites) {
    text += fmt::format("{}: {}, generation {}, {}\n",
                        printable(name),
                        owner_text(view, site.claim),
                        site.claim.generation(),
                        lag_text(site.last, now));
  }
  return text;
}

}  // namespace rayloc::cli
