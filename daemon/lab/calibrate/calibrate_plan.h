// `rayloc calibrate --plan SITE`: plans the points of a survey, as csv and picture.
#pragma once

#include <cstddef>
#include <string>

#include "engine/base/expected.h"

namespace rayloc::cli {

struct PlanArguments {
  std::string site;
  std::string out = "-";    // csv file (planned_points.h); "-" is standard output
  std::string picture;      // .svg or .png; empty: beside the csv as .svg, none for "-"
  std::size_t points = 12;  // half an hour on foot; 36 and 143 constrain one access point better
  bool quiet = false;
};

// Reports on stderr how well the points cover the surfaces, and which surfaces they cover too
// little. Returns an Error if no position is available, or fewer than a calibration needs.
Expected<void> run_plan(const PlanArguments& arguments);

}  // namespace rayloc::cli
