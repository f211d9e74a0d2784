// `rayloc replay --stream`: connects and reports the comparison.
#pragma once

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/history/stream_replay.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

// Returns an Error if a result differs from the published one.
// `fill`: instead publishes what an outage kept from the stream.
Expected<void> replay_cluster(const BrokerOptions& server,
                              const StreamReplay& replay,
                              bool fill,
                              bool quiet);

}  // namespace rayloc::cli
