// Conditions of this machine that prevent a daemon from working: checks of `rayloc doctor`.
#pragma once

#include <vector>

#include "daemon/base/finding.h"
#include "daemon/live/config/config.h"

namespace rayloc {

// Receive buffers, clock, disk, capabilities, interfaces, ports and secrets. `running`: the daemon
// runs, so it is correct that its ports are in use. Changes nothing; ports are bound for an
// instant.
std::vector<Finding> check_machine(const DaemonConfig& config, bool running);

}  // namespace rayloc
