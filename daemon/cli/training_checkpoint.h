// Where a training stood when it was interrupted, as two files in the folder training/ of --out:
// the numbers, and the weights of the network with what its optimiser remembers.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/expected.h"
#include "engine/baselines/training.h"

namespace rayloc::cli {

// `inputs`: hash of everything that the training starts from.
Expected<void> write_checkpoint(const std::filesystem::path& folder,
                                const std::string& method,
                                const std::string& inputs,
                                const TrainingCheckpoint& checkpoint);

// An Error when there is none, it is broken, or of other inputs.
Expected<TrainingCheckpoint> read_checkpoint(const std::filesystem::path& folder,
                                             const std::string& method,
                                             const std::string& inputs);

void remove_checkpoint(const std::filesystem::path& folder, const std::string& method);

}  // namespace rayloc::cli
