// Replay of the data that an outage kept out of a site's stream and that arrived later in the
// history stream: located after arrival, and returned as history. Tracks restart at each outage.
#pragma once

#include <cstddef>

#include "daemon/live/cluster/history/stream_replay.h"

namespace rayloc {

struct FillReport {
  std::size_t batches = 0;
  std::size_t datagrams = 0;  // of access points of the site
  std::size_t items = 0;      // results
};

// An Error where the broker does not answer, or has no history stream.
Expected<FillReport> replay_fill(Broker& broker, const StreamReplay& replay);

}  // namespace rayloc
