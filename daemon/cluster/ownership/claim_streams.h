// The streams that workers make: of claims, of results and of history.
#pragma once

#include <chrono>

#include "daemon/cluster/broker.h"
#include "engine/base/expected.h"

namespace rayloc {

// The stream of claims as it is made where nobody has made it.
StreamOptions claim_stream(StreamOptions options);

// All of them, where they are not there; how that of claims is. `result_age`: how long results are
// kept, ten minutes at least.
Expected<StreamState> make_worker_streams(Broker& broker,
                                          const StreamOptions& claims,
                                          std::chrono::seconds result_age);

}  // namespace rayloc
