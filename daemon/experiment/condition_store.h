// What an experiment has found so far, a file a condition, so that who is interrupted goes on.
#pragma once

#include <filesystem>

#include "daemon/experiment/run_experiment.h"

namespace rayloc {

// In the folder `conditions` of `directory`, by a hash of all that the condition states, the plan
// of its room and the seed. Files that are broken, or of other conditions, count as not there.
ConditionStore condition_store(const std::filesystem::path& directory, bool may_load);

}  // namespace rayloc
