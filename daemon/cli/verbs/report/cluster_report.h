// Text of `rayloc cluster status` and `rayloc cluster sites`.
#pragma once

#include <string>

#include "daemon/live/cluster/cluster_view.h"
#include "engine/base/timestamp.h"

namespace rayloc::cli {

// A line for each worker, one for each site for which it is a standby, and a summary.
std::string workers_text(const ClusterView& view);
// A line for each site: its owner and its progress at `now`.
std::string sites_text(const ClusterView& view, Timestamp now);

}  // namespace rayloc::cli
