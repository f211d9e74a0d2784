// Checks a NATS server by its greeting: its version, JetStream, and the protection of its port.
#pragma once

#include <string>
#include <vector>

#include "daemon/base/finding.h"
#include "daemon/live/cluster/operate/server_greeting.h"
#include "engine/base/expected.h"

namespace rayloc {

// `server`: its address; `greeting`: its greeting, or the reason why there is none.
std::vector<Finding> check_server(const std::string& server,
                                  const Expected<ServerGreeting>& greeting);

}  // namespace rayloc
