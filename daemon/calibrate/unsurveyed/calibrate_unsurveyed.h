// `rayloc calibrate SITE --unsurveyed`: a calibration from recordings of devices that were
// anywhere.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/expected.h"

namespace rayloc::cli {

struct UnsurveyedArguments {
  std::string site;                   // not calibrated
  std::vector<std::string> captures;  // [AP=]FILE; none: the plan is all that is known
  std::string out;                    // folder to create
  std::uint64_t seed = 1;
  bool force = false;
  bool quiet = false;
};

// Without recordings `out` is the plan, with chains that raylocd learns from whoever walks. With
// them first the chains are learned with the room of the plan. Devices are then located, and where
// they surely were is the survey from which walls, arrays and chains are calibrated; it is left as
// `places.csv`. Where too little is sure, or the room is explained no better than before, `out`
// keeps the plan with the learned chains, and standard error says so.
Expected<void> run_unsurveyed(const UnsurveyedArguments& arguments);

}  // namespace rayloc::cli
