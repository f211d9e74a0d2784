// Requests a worker to give back its sites, so that it may be stopped.
#pragma once

#include <string>

#include "daemon/live/cluster/broker.h"
#include "engine/base/expected.h"

namespace rayloc {

// Repeats the request until the worker reports that it has no sites, for up to the longest lease,
// 60 s. kUnavailable: the worker does not report, or keeps its sites.
Expected<void> drain_worker(Broker& broker, const std::string& worker);

}  // namespace rayloc
