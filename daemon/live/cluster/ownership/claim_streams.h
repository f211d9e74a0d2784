// Streams that workers create: claims, results and history.
#pragma once

#include <chrono>

#include "daemon/live/cluster/broker.h"
#include "engine/base/expected.h"

namespace rayloc {

// Configuration of the stream of claims, for its creation.
StreamOptions claim_stream(StreamOptions options);

// Creates the missing ones; returns the state of the stream of
// claims. `result_age`: retention of results, ten minutes at least.
Expected<StreamState> make_worker_streams(Broker& broker,
                                          const StreamOptions& claims,
                                          std::chrono::seconds result_age);

}  // namespace rayloc
