// `rayloc calibrate --plan SITE`: where to stand in a survey, as csv and picture.
#pragma once

#include <cstddef>
#include <string>

#include "engine/base/expected.h"

namespace rayloc::cli {

struct PlanArguments {
  std::string site;
  std::string out = "-";    // the csv (planned_points.h); "-" is standard output
  std::string picture;      // .svg or .png; empty: beside the csv as .svg, none for "-"
  std::size_t points = 12;  // half an hour on foot; 36 and 143 say more of one access point
  bool quiet = false;
};

// Says on stderr how much the points see, and which surfaces they see too little of. An Error when
// there is no place to stand, or fewer than a calibration needs.
Expected<void> run_plan(const PlanArguments& arguments);

}  // namespace rayloc::cli
