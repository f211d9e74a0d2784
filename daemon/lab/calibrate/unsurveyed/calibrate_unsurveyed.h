// Calibration without a survey as a use case: from
// recordings of devices at unknown positions.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "daemon/lab/calibrate/calibrate.h"
#include "daemon/lab/calibrate/calibrate_rechain.h"
#include "engine/base/expected.h"

namespace rayloc {

struct UnsurveyedArguments {
  std::string site;                   // uncalibrated site
  std::vector<std::string> captures;  // [AP=]FILE; none: only the plan is available
  std::string out;                    // output folder, created
  std::uint64_t seed = 1;
  bool force = false;
  FitControl control = {};
};

// The content of the output.
enum class UnsurveyedOutcome : std::uint8_t {
  kPlan,    // the plan, with unknown chains
  kChains,  // walls of the plan, with learned chains
  kWalls,   // calibrated walls, arrays and chains
};

// Also receives the results of the steps, each before the next one begins. Empty functions: they
// are not reported.
struct UnsurveyedObserver : FitObserver {
  std::function<void(const RechainResult& chains)> on_chains;
  std::function<void(const CalibrationResult& calibration)> on_calibration;
};

// Without recordings `out` is the plan, with chains that raylocd learns from moving devices. With
// recordings the chains are learned first, with the room of the plan. Devices are then located, and
// their reliable positions are the survey from which walls, arrays and chains are calibrated; it is
// left as `places.csv`. If too few are certain, or the room is explained no better than before,
// `out` keeps the plan with the learned chains, and a note reports it. In each case `out` has
// report.json and report.html, which begin with a verdict. Threads may run it at the
// same time, each into a folder of its own.
Expected<UnsurveyedOutcome> run_unsurveyed(const UnsurveyedArguments& arguments,
                                           const UnsurveyedObserver& observer = {});

}  // namespace rayloc
