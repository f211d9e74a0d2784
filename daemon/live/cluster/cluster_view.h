// ClusterView: state of a cluster as seen from its broker: live
// workers, owners of sites, and the progress of each site.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <string>

#include "daemon/live/cluster/broker.h"
#include "engine/base/timestamp.h"
#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

struct ClusterView {
  struct Worker {
    v1::WorkerState state;
    Timestamp received;  // by the clock of this machine
  };
  std::map<std::string, Worker> workers;  // received, by name
  struct Site {
    v1::SiteClaim claim;
    v1::OutputRecord last;  // last of its results; empty: none
  };
  std::map<std::string, Site> sites;  // claimed and not removed, by name

  // Returns true if a state of the worker that claimed it was received.
  bool has_owner(const v1::SiteClaim& claim) const;
  // Number of sites whose owner is missing.
  std::size_t sites_without_owner() const;
};

// Listens to workers until each owner of a site has reported and half a lease has passed, a
// lease at most: they report four times within it. An Error where the broker does not answer.
Expected<ClusterView> inspect_cluster(Broker& broker);
// Returns true if it connects within `patience`.
bool wait_for_broker(const Broker& broker, std::chrono::milliseconds patience);

}  // namespace rayloc
