// Summary of `rayloc train` on standard error.
#pragma once

#include "daemon/lab/train/train_inputs.h"
#include "daemon/lab/train/train_method.h"

namespace rayloc::cli {

// REQUIRES: `trained` from `inputs`.
void print_trained(const TrainInputs& inputs, const TrainedMethod& trained);

}  // namespace rayloc::cli
