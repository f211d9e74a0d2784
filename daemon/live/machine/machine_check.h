// Conditions of this machine that prevent a daemon from working: checks of `rayloc doctor`.
#pragma once

#include <string>
#include <vector>

#include "daemon/live/config/config.h"

namespace rayloc {

struct Finding {
  enum class Kind { kOk, kWarning, kProblem };
  Kind kind = Kind::kOk;
  std::string what;
  std::string advice;  // remedy; empty when there is no fault
};

// Receive buffers, clock, disk, capabilities, interfaces, ports and secrets. `running`: the daemon
// runs, so it is correct that its ports are in use. Changes nothing; ports are bound for an
// instant.
std::vector<Finding> check_machine(const DaemonConfig& config, bool running);

}  // namespace rayloc
