// `rayloc calibrate SITE --unsurveyed`: a calibration
// from recordings of devices at unknown positions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/lab/calibrate/calibrate.h"
#include "engine/base/expected.h"

namespace rayloc::cli {

struct UnsurveyedArguments {
  std::string site;                   // uncalibrated site
  std::vector<std::string> captures;  // [AP=]FILE; none: only the plan is available
  std::string out;                    // output folder, created
  std::uint64_t seed = 1;
  bool force = false;
  bool quiet = false;
  FitControl control = {};
};

// Without recordings `out` is the plan, with chains that raylocd learns from moving devices. With
// recordings the chains are learned first, with the room of the plan. Devices are then located, and
// their reliable positions are the survey from which walls, arrays and chains are calibrated; it is
// left as `places.csv`. If too few are certain, or the room is explained no better than before,
// `out` keeps the plan with the learned chains, and standard error reports it.
Expected<void> run_unsurveyed(const UnsurveyedArguments& arguments);

}  // namespace rayloc::cli
