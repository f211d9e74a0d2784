// `rayloc replay --stream`: replays the streams of a cluster's broker and reports the comparison.
#pragma once

#include "daemon/cli/verbs/arguments/replay_arguments.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

// Replays the owners of a site one after the other, each with estimators of its own. Returns an
// Error if a result differs from the published one. With --fill it replays instead what an outage
// kept from the stream.
Expected<void> replay_cluster(const ReplayArguments& arguments,
                              const Site& site,
                              const replay::Options& options);

}  // namespace rayloc::cli
