// Final report of `rayloc replay` on its inputs.
#pragma once

#include <vector>

#include "capture/source/recorded_source.h"
#include "daemon/pipeline/pipeline.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

// Reports on standard error, unless `quiet`, what was read and its outcome. Returns an Error for
// every source that ended prematurely, and if packets contain no CSI at all. `recordings`: the
// pipeline's inputs, in their order.
Expected<void> report_replay(const Pipeline& pipeline,
                             const std::vector<const RecordedSource*>& recordings,
                             bool quiet);

}  // namespace rayloc::cli
