#include "daemon/cli/verbs/replay_cluster.h"

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "daemon/cli/terminal/terminal_notes.h"
#include "daemon/cli/verbs/report/replay_files.h"
#include "daemon/cli/verbs/report/replay_report.h"
#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/cluster_view.h"
#include "daemon/live/cluster/history/fill_replay.h"
#include "daemon/live/cluster/history/stream_replay.h"
#include "daemon/live/cluster/site_start.h"
#include "engine/base/printable.h"

namespace rayloc::cli {
namespace {

constexpr std::chrono::seconds kReplayBrokerTimeout{3};  // for an answer of the broker

Expected<void> replay_history(Broker& broker, const StreamReplay& replay, bool quiet) {
  const auto report = replay_fill(broker, replay);
  RAYLOC_TRY(report);
  if (!quiet) {
    std::fprintf(stderr,
                 "%zu results of %zu datagrams that came later, in %zu batches\n",
                 report->items,
                 report->datagrams,
                 report->batches);
  }
  return {};
}

Expected<void> compare_with_published(const BrokerOptions& server,
                                      const StreamReplay& replay,
                                      bool fill,
                                      bool quiet) {
  const auto broker = open_broker(server);
  RAYLOC_TRY(broker);
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
  RAYLOC_TRY(report);
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

}  // namespace

Expected<void> replay_cluster(const ReplayArguments& arguments,
                              const Site& site,
                              const replay::Options& options) {
  auto files = ReplayFiles::open(arguments.format, {arguments.out, arguments.zone_events});
  RAYLOC_TRY(files);
  StreamReplay replay;
  replay.site = site.name;
  replay.uninterrupted = arguments.uninterrupted;
  replay.access_points = access_point_ids(site);
  replay.on_result = [&](const v1::OutputItem& item) {
    if (item.has_location()) {
      files->write_location(item.location());
    } else if (item.has_zone()) {
      files->write_event(item.zone());
    }
  };
  replay.run = [&](const SiteStart& start,
                   std::vector<std::unique_ptr<DatagramSource>> sources,
                   LocationSink& sink) {
    return replay::run_streams(site,
                               options,
                               {std::move(sources), start.from, start.carried},
                               sink,
                               terminal_notes(arguments.quiet));
  };
  BrokerOptions broker = arguments.broker;
  broker.servers = {arguments.stream};
  broker.name = "rayloc replay";
  Expected<void> replayed = compare_with_published(broker, replay, arguments.fill, arguments.quiet);
  RAYLOC_TRY(files->close());
  return replayed;
}

}  // namespace rayloc::cli
