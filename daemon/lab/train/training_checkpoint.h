// State of an interrupted training as two files in the folder training/ of --out: the numbers, and
// the weights of the network with the state of the optimizer.
#pragma once

#include <filesystem>
#include <string>

#include "engine/base/expected.h"
#include "engine/baselines/training.h"

namespace rayloc {

// `inputs`: hash of all inputs of the training.
Expected<void> write_checkpoint(const std::filesystem::path& folder,
                                const std::string& method,
                                const std::string& inputs,
                                const TrainingCheckpoint& checkpoint);

// Returns an Error if there is none, it is broken, or it was made from other inputs.
Expected<TrainingCheckpoint> read_checkpoint(const std::filesystem::path& folder,
                                             const std::string& method,
                                             const std::string& inputs);

void remove_checkpoint(const std::filesystem::path& folder, const std::string& method);

}  // namespace rayloc
