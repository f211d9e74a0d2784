// Prints the findings of a doctor verb for people.
#pragma once

#include <vector>

#include "daemon/base/finding.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

// Prints a line for each; returns an Error without a message (status 69) if one is a problem.
Expected<void> print_findings(const std::vector<Finding>& findings);

}  // namespace rayloc::cli
