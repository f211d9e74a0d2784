// What of this machine stands in the way of a daemon: what `rayloc doctor` looks at.
#pragma once

#include <string>
#include <vector>

#include "daemon/config/config.h"

namespace rayloc {

struct Finding {
  enum class Kind { kOk, kWarning, kProblem };
  Kind kind = Kind::kOk;
  std::string what;
  std::string advice;  // what to do; empty when all is well
};

// Receive buffers, clock, disk, capabilities, interfaces, ports and secrets. `running`:
// the daemon runs, so its ports are taken as they should be. Changes nothing; ports are bound for
// an instant.
std::vector<Finding> check_machine(const DaemonConfig& config, bool running);

}  // namespace rayloc
