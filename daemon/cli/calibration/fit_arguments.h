// Checks the arguments of a calibration from a survey before any file is read.
#pragma once

#include "daemon/lab/calibrate/calibrate.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

// Errors are of kind kUsage and name the option.
Expected<void> check_fit_arguments(const CalibrateArguments& arguments);

}  // namespace rayloc::cli
