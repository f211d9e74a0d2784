#include "daemon/pipeline/device/calibration_warnings.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace rayloc::calibration_warnings_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

CalibrationWarning warning(CalibrationProblem problem, std::size_t ap, const std::string& text) {
  CalibrationWarning made;
  made.problem = problem;
  made.access_point = ap;
  made.text = text;
  return made;
}

std::vector<std::string> texts(const CalibrationWarnings& warnings) {
  std::vector<std::string> all;
  for (const CalibrationWarning& one : warnings.now()) {
    all.push_back(one.text);
  }
  return all;
}

TEST(CalibrationWarnings, StateAFaultOnceWithTheMonitorsNumbers) {
  CalibrationWarnings warnings;
  warnings.set({warning(CalibrationProblem::kChainPhaseJump, 0, "jump of 92 degrees")},
               {warning(CalibrationProblem::kChainPhaseJump, 0, "learning ap1"),
                warning(CalibrationProblem::kChainPhaseJump, 1, "learning ap2")},
               {warning(CalibrationProblem::kDeadChain, 0, "dead chain")});
  EXPECT_THAT(texts(warnings), ElementsAre("jump of 92 degrees", "learning ap2", "dead chain"));
  warnings.set({}, {warning(CalibrationProblem::kChainPhaseJump, 0, "learning ap1")}, {});
  EXPECT_THAT(texts(warnings), ElementsAre("learning ap1"));
  warnings.clear();
  EXPECT_THAT(texts(warnings), IsEmpty());
}

TEST(CalibrationWarnings, AreInEveryLocationExceptThoseOfDeadChains) {
  std::vector<Location> locations(2);
  locations[1].estimate.warnings = {"of its own"};
  append_texts({warning(CalibrationProblem::kDeadChain, 0, "dead chain"),
                warning(CalibrationProblem::kResidualDrift, 0, "drift"),
                warning(CalibrationProblem::kAccessPointMoved, 1, "moved")},
               locations);
  EXPECT_THAT(locations[0].estimate.warnings, ElementsAre("drift", "moved"));
  EXPECT_THAT(locations[1].estimate.warnings, ElementsAre("of its own", "drift", "moved"));
}

}  // namespace
}  // namespace rayloc::calibration_warnings_test
