// The plan of a survey as csv and picture, and its coverage and expected accuracy on stderr.
#pragma once

#include <string>

#include "daemon/lab/calibrate/calibrate_plan.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

struct PlanOutput {
  std::string csv = "-";  // file (planned_points.h); "-" is standard output
  std::string picture;    // .svg or .png; empty: beside the csv as .svg, none for "-"
  bool quiet = false;     // nothing on stderr
};

// Returns an Error of kind kUsage for another ending of the picture, and if a file cannot be
// written.
Expected<void> write_plan(const PlannedSurvey& planned, const PlanOutput& output);

}  // namespace rayloc::cli
