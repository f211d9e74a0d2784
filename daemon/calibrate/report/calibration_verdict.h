// CalibrationVerdict: whether a calibration is a success, and if not, what may be wrong.
#pragma once

#include <string>
#include <vector>

#include "engine/calibrate/check/input_check.h"

namespace rayloc {

struct CalibrationReport;

struct CalibrationVerdict {
  std::vector<std::string> reasons;  // why it is none; empty: a success, as far as anybody can tell
  std::vector<TriedMistake> found;   // what explains the survey clearly better than what was stated
  std::vector<TriedMistake> tried;   // what gains most first

  bool is_success() const { return reasons.empty(); }
};

// The verdict of the inputs alone: each mistake that was found is a reason.
CalibrationVerdict verdict_of_inputs(const InputCheck& check);

// Adds what the points held out say of the first method: that they are explained less than before,
// or that at half of them or more the room explains what was heard no better than diffuse
// scattering does, so that there is no fix. Of the first nothing is said with fewer than
// kLeastPairs points (of four points of a right survey the median fell from 0.73 to 0.60), of the
// second with fewer than kLeastJudged; nor of a calibration that was interrupted: it goes on.
constexpr std::size_t kLeastJudged = 3;
void judge_held_out(const CalibrationReport& report, CalibrationVerdict& verdict);

// What else was tried, of a calibration that is none; where one is clearly better it is found.
void add_carriers(const std::vector<TriedMistake>& carriers, CalibrationVerdict& verdict);

// A line for each reason, and what was tried; of a success nothing.
std::string to_text(const CalibrationVerdict& verdict);

}  // namespace rayloc
