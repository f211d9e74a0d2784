// CalibrationVerdict: success or failure of a calibration, with likely causes of a failure.
#pragma once

#include <string>
#include <vector>

#include "engine/calibrate/check/input_check.h"

namespace rayloc {

struct CalibrationReport;

struct CalibrationVerdict {
  std::vector<std::string> reasons;  // reasons of a failure; empty: a success, as far as known
  std::vector<TriedMistake> found;   // changes that explain the survey clearly better
  std::vector<TriedMistake> tried;   // largest gain first

  bool is_success() const { return reasons.empty(); }
};

// The verdict on the inputs alone: each error that was found is a reason.
CalibrationVerdict verdict_of_inputs(const InputCheck& check);

// Adds the verdict of the held-out points on the first method: that they are explained less than
// before, or that at half of them or more the room explains the observations no better than diffuse
// scattering does, so that there is no fix. The first is not evaluated with fewer than kMinPairs
// points (of four points of a right survey the median fell from 0.73 to 0.60), the second with
// fewer than kMinJudged, and neither for an interrupted calibration, which continues.
constexpr std::size_t kMinJudged = 3;
void judge_held_out(const CalibrationReport& report, CalibrationVerdict& verdict);

// Adds other carriers tried after a failure; one that is clearly better is added to `found`.
void add_carriers(const std::vector<TriedMistake>& carriers, CalibrationVerdict& verdict);

// A line for each reason, and the alternatives that were tried; empty for a success.
std::string to_text(const CalibrationVerdict& verdict);

}  // namespace rayloc
