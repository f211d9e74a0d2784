// `rayloc replay --stream`: connects, and says what came of it.
#pragma once

#include "daemon/cluster/broker.h"
#include "daemon/cluster/history/stream_replay.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

// An Error where something differs from what was published.
// `fill`: instead, what an outage kept from the stream.
Expected<void> replay_cluster(const BrokerOptions& server,
                              const StreamReplay& replay,
                              bool fill,
                              bool quiet);

}  // namespace rayloc::cli
