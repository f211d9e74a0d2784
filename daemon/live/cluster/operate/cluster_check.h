// Checks a cluster for `rayloc cluster doctor`: its servers, streams, workers, sites and capture
// nodes. Only reads.
#pragma once

#include <string>
#include <vector>

#include "daemon/base/finding.h"
#include "daemon/live/cluster/broker.h"

namespace rayloc {

struct ServerFindings {
  std::vector<Finding> findings;
  bool has_several_servers = false;  // a server belongs to a cluster of servers
};
// Requests the greeting of each server; waits up to 2 s for each.
ServerFindings check_servers(const std::vector<std::string>& servers);

// Checks everything that the broker has; a check that fails is a problem among the findings.
std::vector<Finding> check_cluster(Broker& broker, bool has_several_servers);

}  // namespace rayloc
