// ClusterView: what a cluster looks like from its broker: who lives, who owns which site, and how
// far each site is.
#pragma once

#include <map>
#include <string>

#include "daemon/cluster/broker.h"
#include "engine/base/timestamp.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

struct ClusterView {
  struct Worker {
    v1::WorkerState state;
    Timestamp heard;  // by the clock of who looks
  };
  std::map<std::string, Worker> workers;  // that were heard, by name
  struct Site {
    v1::SiteClaim claim;
    v1::OutputRecord last;  // of its results; empty: none
  };
  std::map<std::string, Site> sites;  // that were claimed and not removed, by name

  // Whether the worker that claimed it was heard.
  bool has_owner(const v1::SiteClaim& claim) const;
};

// Listens to workers until all that own sites were heard and half a lease has passed, a lease at
// most: they say four times within it that they live. An Error where the broker does not answer.
Expected<ClusterView> look_at_cluster(Broker& broker);
// Whether it connects in that time.
bool wait_for_broker(const Broker& broker, std::chrono::milliseconds patience);

}  // namespace rayloc
