#include "daemon/live/cluster/ownership/claim_streams.h"

#include <algorithm>

#include "daemon/live/cluster/capture_role.h"
#include "daemon/live/cluster/cluster_names.h"

namespace rayloc {
namespace {

constexpr std::chrono::minutes kKeepResults{10};  // minimum, for gateways that were away

}  // namespace

StreamOptions claim_stream(StreamOptions options) {
  options.name = kClaimStream;
  options.subjects = kClaimSubjects;
  options.republish_to = kClaimsAgain;
  options.in_memory = false;
  options.max_age = std::chrono::seconds(0);
  options.max_messages_per_subject = 1;
  return options;
}

// Creates all of them here: workers with their first claims would create the others concurrently.
Expected<StreamState> make_worker_streams(Broker& broker,
                                          const StreamOptions& claims,
                                          std::chrono::seconds result_age) {
  StreamOptions results = claims;
  results.max_messages_per_subject = 0;
  results.max_age = std::max<std::chrono::seconds>(result_age, kKeepResults);
  for (const StreamOptions& stream : {claims, output_stream(results), fill_stream(results)}) {
    RAYLOC_TRY(broker.ensure_stream(stream));
  }
  return broker.stream_state(claims.name);
}

}  // namespace rayloc
