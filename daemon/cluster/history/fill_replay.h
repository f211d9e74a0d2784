// What an outage kept from a site's stream and came later, into the stream of history: located once
// it is there, and told as history to whoever asks. Tracks begin anew where an outage begins.
#pragma once

#include <cstddef>

#include "daemon/cluster/history/stream_replay.h"

namespace rayloc {

struct FillReport {
  std::size_t batches = 0;
  std::size_t datagrams = 0;  // of access points of the site
  std::size_t items = 0;      // results
};

// An Error where the broker does not answer, or has no stream of history.
Expected<FillReport> replay_fill(Broker& broker, const StreamReplay& replay);

}  // namespace rayloc
