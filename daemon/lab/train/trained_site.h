// write_trained_site: writes a site with its trained method into a folder.
#pragma once

#include <filesystem>

#include "daemon/lab/train/train_inputs.h"
#include "daemon/lab/train/train_method.h"
#include "engine/base/expected.h"

namespace rayloc {

// Writes into `out`, which exists: a copy of the site, training/METHOD.toml, the weights of a
// network and METHOD-report.json; then removes the checkpoint. An Error if a file cannot be read or
// written.
Expected<void> write_trained_site(const TrainInputs& inputs,
                                  const TrainedMethod& trained,
                                  const std::filesystem::path& out);

}  // namespace rayloc
