// What `rayloc replay` says at its end of what it read.
#pragma once

#include <vector>

#include "capture/source/recorded_source.h"
#include "daemon/pipeline/pipeline.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

// What was read and what became of it, on standard error unless `quiet`. An Error for every source
// that ended before its time, and where packets hold no CSI at all. `recordings`: of the pipeline's
// inputs, in their order.
Expected<void> report_replay(const Pipeline& pipeline,
                             const std::vector<const RecordedSource*>& recordings,
                             bool quiet);

}  // namespace rayloc::cli
