// What a doctor has found, for people.
#pragma once

#include <vector>

#include "daemon/machine/machine_check.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

// A line for each; an Error that says no more (status 69) where one is a problem.
Expected<void> print_findings(const std::vector<Finding>& findings);

}  // namespace rayloc::cli
