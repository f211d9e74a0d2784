#include "daemon/live/service/process_metrics.h"

#include <cstdint>
#include <string>
#include <utility>

#include "daemon/live/log/log.h"

namespace rayloc {
namespace {

std::uint64_t sum_of(const NumberedRing::Counts& counts) {
  std::uint64_t all = 0;
  for (const auto& [access_point, count] : counts) {
    all += count;
  }
  return all;
}

ExtraMetric replica_metric(const ReplicaWatch& replicas) {
  ExtraMetric faults{
      "rayloc_cluster_replica_faults",
      "Per stream, replicas that are offline or behind, plus 1 without a leader; without a name: 1 "
      "if no server answers",
      false,
      {}};
  const auto by_stream = replicas.faults();
  if (!by_stream) {
    faults.samples.push_back({"stream", "", 1.0});
    return faults;
  }
  for (const auto& [stream, count] : *by_stream) {
    faults.samples.push_back({"stream", stream, static_cast<double>(count)});
  }
  if (by_stream->empty()) {
    faults.samples.push_back({"stream", "", 0.0});
  }
  return faults;
}

}  // namespace

std::vector<ExtraMetric> http_metrics(const HttpCounters& http) {
  std::vector<ExtraMetric> metrics;
  ExtraMetric requests{"rayloc_http_requests_total", "Answers over HTTP by status", true, {}};
  for (const auto& [status, count] : http.requests) {
    requests.samples.push_back({"status", std::to_string(status), static_cast<double>(count)});
  }
  metrics.push_back(std::move(requests));
  metrics.push_back({"rayloc_http_closed_total",
                     "HTTP connections closed by us before their answer was fetched",
                     true,
                     {{"reason", "slow", static_cast<double>(http.timed_out)},
                      {"reason", "displaced", static_cast<double>(http.displaced)}}});
  metrics.push_back({"rayloc_http_viewers",
                     "Open streams of events",
                     false,
                     {{"", "", static_cast<double>(http.viewers)}}});
  metrics.push_back({"rayloc_http_viewers_ended_total",
                     "Streams of events that ended or were refused",
                     true,
                     {{"reason", "left", static_cast<double>(http.viewers_left)},
                      {"reason", "stuck", static_cast<double>(http.viewers_stuck)},
                      {"reason", "refused", static_cast<double>(http.viewers_refused)}}});
  metrics.push_back({"rayloc_http_events_total",
                     "Events given to viewers, all together",
                     true,
                     {{"", "", static_cast<double>(http.events)}}});
  metrics.push_back({"rayloc_http_messages_coalesced_total",
                     "Messages that newer ones replaced before a viewer was asked, all together",
                     true,
                     {{"", "", static_cast<double>(http.messages_coalesced)}}});
  return metrics;
}

ExtraMetric snapshot_metric(const SnapshotCounters& snapshots) {
  return {"rayloc_snapshot_requests_total",
          "Requests of late subscribers by what became of them",
          true,
          {{"result", "answered", static_cast<double>(snapshots.answered)},
           {"result", "malformed", static_cast<double>(snapshots.malformed)},
           {"result", "dropped", static_cast<double>(snapshots.dropped)}}};
}

ExtraMetric ring_metric(const SiteSet& sites) {
  RingSnapshotCounters rings;
  for (const SiteSet::Site& site : sites.all()) {
    if (const RingSnapshots* const some = site->runtime->ring_snapshots(); some != nullptr) {
      rings.files += some->counters().files;
      rings.failed += some->counters().failed;
    }
  }
  return {"rayloc_recorder_snapshot_files_total",
          "Requested files of recent datagrams, by result",
          true,
          {{"result", "written", static_cast<double>(rings.files)},
           {"result", "failed", static_cast<double>(rings.failed)}}};
}

ExtraMetric log_metric() {
  return {"rayloc_log_dropped_total",
          "Messages of the log that newer ones displaced before a client read them",
          true,
          {{"", "", static_cast<double>(log_entries_dropped())}}};
}

ExtraMetric running_sites_metric(const SiteSet& sites) {
  ExtraMetric metric{"rayloc_site_running",
                     "0 for a site of the configuration that has ended or never begun",
                     false,
                     {}};
  for (const SiteSet::Site& site : sites.all()) {
    metric.samples.push_back({"site", site->name(), site->has_ended ? 0.0 : 1.0});
  }
  for (const auto& [name, why] : sites.absent()) {
    metric.samples.push_back({"site", name, 0.0});
  }
  return metric;
}

ExtraMetric history_metric(const SiteSet& sites) {
  std::uint64_t marked = 0;
  std::uint64_t filled = 0;
  std::uint64_t waiting = 0;
  for (const SiteSet::Site& site : sites.all()) {
    if (const BatchSender* const sender = site->runtime->sender(); sender != nullptr) {
      const BatchSender::Counters counters = sender->counters();
      marked += sum_of(counters.ring.marked);
      filled += sum_of(counters.filled);
      waiting += sum_of(counters.to_fill);
    }
  }
  return {"rayloc_cluster_history_datagrams",
          "Datagrams in marks of gaps by where they are",
          false,
          {{"state", "filled_in", static_cast<double>(filled)},
           {"state", "waiting", static_cast<double>(waiting)},
           {"state", "recordings_alone", static_cast<double>(marked - filled - waiting)}}};
}

std::vector<ExtraMetric> cluster_metrics(const Broker& broker,
                                         const ClaimKeeper* claims,
                                         const ReplicaWatch* replicas,
                                         const SiteSet& sites) {
  std::vector<ExtraMetric> metrics = {{"rayloc_cluster_broker_connected",
                                       "1 where a server of the cluster answers",
                                       false,
                                       {{"", "", broker.connected() ? 1.0 : 0.0}}},
                                      {"rayloc_cluster_broker_connections_total",
                                       "How often this machine has connected to a server",
                                       true,
                                       {{"", "", static_cast<double>(broker.connections())}}},
                                      {"rayloc_cluster_broker_failed_tries_total",
                                       "Tries to make a connection that failed",
                                       true,
                                       {{"", "", static_cast<double>(broker.failed_tries())}}}};
  if (claims != nullptr) {
    metrics.push_back({"rayloc_cluster_worker_sites",
                       "Sites of this worker by whether it works for them",
                       false,
                       {{"state", "owned", static_cast<double>(sites.all().size())},
                        {"state", "waiting", static_cast<double>(sites.absent().size())}}});
    metrics.push_back({"rayloc_cluster_worker_leaving",
                       "1 while it gives its sites back and takes no more",
                       false,
                       {{"", "", claims->is_leaving() ? 1.0 : 0.0}}});
  }
  if (replicas != nullptr) {
    metrics.push_back(replica_metric(*replicas));
  }
  return metrics;
}

}  // namespace rayloc
