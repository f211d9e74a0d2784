// Summary of `rayloc reference` on standard error.
#pragma once

#include "daemon/lab/reference/learn_reference.h"
#include "daemon/lab/reference/reference_inputs.h"

namespace rayloc::cli {

// REQUIRES: `learned` from `inputs`.
void print_reference(const ReferenceInputs& inputs, const LearnedReference& learned);

}  // namespace rayloc::cli
