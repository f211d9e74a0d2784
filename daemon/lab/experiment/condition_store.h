// Results of an experiment so far, one file per condition, so that an interrupted run resumes.
#pragma once

#include <filesystem>

#include "daemon/lab/experiment/run_experiment.h"

namespace rayloc {

// Stores in the folder `conditions` of `directory`, keyed by a hash of all keys of the condition,
// the plan of its room and the seed. Files that are broken, or of other conditions, are ignored.
ConditionStore condition_store(const std::filesystem::path& directory, bool may_load);

}  // namespace rayloc
