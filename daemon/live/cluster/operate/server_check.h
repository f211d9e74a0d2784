// Checks a NATS server by its greeting: its version, JetStream, and the protection of its port.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "daemon/base/finding.h"
#include "daemon/live/cluster/operate/server_greeting.h"
#include "engine/base/expected.h"

namespace rayloc {

// The oldest nats-server for several servers. Older ones have lost messages of replicated streams
// after a node was cut off for 6 s (2.9.10), or lost streams (until 2.10.22), and answer no direct
// get on a follower that was a candidate (2.14.5): a reader that asks it reads no further.
inline constexpr std::array<int, 3> kClusterServer{2, 14, 6};

// `version`: "2.14.6"; also true if it does not have three numbers. A single server may be older.
bool is_too_old_for_clusters(const std::string& version);

// `server`: its address; `greeting`: its greeting, or the reason why there is none.
std::vector<Finding> check_server(const std::string& server,
                                  const Expected<ServerGreeting>& greeting);

}  // namespace rayloc
