#include "daemon/cli/verbs/replay_cluster.h"

#include <chrono>
#include <cstdio>

#include <fmt/format.h>

#include "daemon/live/cluster/cluster_view.h"
#include "daemon/live/cluster/history/fill_replay.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

constexpr std::chrono::seconds kReplayBrokerTimeout{3};  // for an answer of the broker

Expected<void> replay_history(Broker& broker, const StreamReplay& replay, bool quiet) {
  const auto report = replay_fill(broker, replay);
  if (!report) {
    return tl::make_unexpected(report.error());
  }
  if (!quiet) {
    std::fprintf(stderr,
                 "%zu results of %zu datagrams that came later, in %zu batches\n",
                 report->items,
                 report->datagrams,
                 report->batches);
  }
  return {};
}

}  // namespace

Expected<void> replay_cluster(const BrokerOptions& server,
                              const StreamReplay& replay,
                              bool fill,
                              bool quiet) {
  const auto broker = open_broker(server);
  if (!broker) {
    return tl::make_unexpected(broker.error());
  }
  if (!wait_for_broker(**broker, kReplayBrokerTimeout)) {
    const std::string refusal = (*broker)->refusal();
    return make_error(ErrorKind::kUnavailable,
                      "--stream: no NATS server answers at " + server.servers.front() +
                          (refusal.empty() ? "" : ": " + refusal + "; see --tls-ca and --nkey"));
  }
  if (fill) {
    return replay_history(**broker, replay, quiet);
  }
  const auto report = replay_stream(*broker, replay);
  if (!report) {
    return tl::make_unexpected(report.error());
  }
  for (const std::string& note : report->notes) {
    std::fprintf(stderr, "rayloc replay: %s\n", printable(note).c_str());
  }
  if (!quiet) {
    std::fprintf(stderr,
                 "%zu results of %zu owners, %zu other than published\n",
                 report->items,
                 report->owners,
                 report->differing);
  }
  if (report->differing > 0) {
    return make_error(ErrorKind::kBadInput,
                      fmt::format("{} results are not those that were published: replay with the "
                                  "site, the options and the build of the workers",
                                  report->differing));
  }
  return {};
}

}  // namespace rayloc::cli
