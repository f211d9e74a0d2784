// Metrics of raylocd beside the heartbeats of its sites: HTTP, snapshots, log, cluster.
#pragma once

#include <utility>
#include <vector>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/operate/replica_watch.h"
#include "daemon/live/cluster/ownership/claim_keeper.h"
#include "daemon/live/http/http_server.h"
#include "daemon/live/http/metrics.h"
#include "daemon/live/publish/snapshot_server.h"
#include "daemon/live/service/site/site_set.h"

namespace rayloc {

std::vector<ExtraMetric> http_metrics(const HttpCounters& http);
ExtraMetric snapshot_metric(const SnapshotCounters& snapshots);
// Files of recent datagrams, over all sites.
ExtraMetric ring_metric(const SiteSet& sites);
// Messages of the log that no client has read.
ExtraMetric log_metric();
// Configured sites, by whether they run.
ExtraMetric running_sites_metric(const SiteSet& sites);
// For a capture node: state of the datagrams that are missing according to marks of gaps.
ExtraMetric history_metric(const SiteSet& sites);
// For a machine of a cluster. `claims`: of a worker, `replicas`: of a gateway; null: it is none.
std::vector<ExtraMetric> cluster_metrics(const Broker& broker,
                                         const ClaimKeeper* claims,
                                         const ReplicaWatch* replicas,
                                         const SiteSet& sites);

}  // namespace rayloc
