// Checks the workers of a cluster and the owners of its sites, as a ClusterView has them.
#pragma once

#include <vector>

#include "daemon/base/finding.h"
#include "daemon/live/cluster/cluster_view.h"

namespace rayloc {

// Load and clock of each worker, and settings that all of them must share.
std::vector<Finding> check_workers(const ClusterView& view);
// The owner of each site.
std::vector<Finding> check_owners(const ClusterView& view);

}  // namespace rayloc
