#include "daemon/cli/calibration/calibration_progress.h"

#include <string>

#include <gtest/gtest.h>

namespace rayloc::cli::calibration_progress_test {
namespace {

CalibrationProgress fitting() { return {{"fit", 12, 0.31214, 0.8713}, 0.5, 57}; }

TEST(CalibrationProgressText, ReportsProgressAndRemainingTime) {
  EXPECT_EQ(progress_text("joint", fitting(), 19.6, 100),
            "joint: about 20 s left, 57 points, fit, step 12, loss 0.3121, held-out 0.871");
  EXPECT_EQ(progress_text("joint", fitting(), std::nullopt, 100),
            "joint: 57 points, fit, step 12, loss 0.3121, held-out 0.871");
}

// Losses of the two methods are of different sizes.
TEST(CalibrationProgressText, ShowsFourDigitsOfALoss) {
  CalibrationProgress progress = fitting();
  progress.step.loss = 0.00071234;
  EXPECT_NE(progress_text("joint", progress, {}, 100).find("loss 0.0007123,"), std::string::npos);
  progress.step.loss = 1234.567;
  EXPECT_NE(progress_text("paper", progress, {}, 100).find("loss 1235,"), std::string::npos);
}

TEST(CalibrationProgressText, FitsIntoTheLine) {
  for (const std::size_t columns : {1U, 20U, 40U}) {
    EXPECT_EQ(progress_text("joint", fitting(), 19.6, columns).size(), columns - 1);
  }
  EXPECT_EQ(progress_text("joint", fitting(), 19.6, 20), "joint: about 20 s l");
}

TEST(CalibrationProgressText, EstimatesTheRemainingTimeFromThisRunOnly) {
  EXPECT_FALSE(seconds_left(1.0, 0.0, 0.01));
  EXPECT_DOUBLE_EQ(seconds_left(10.0, 0.0, 0.25).value(), 30.0);
  // Gone on from half of the work: the first half took no time of this run.
  EXPECT_FALSE(seconds_left(1.0, 0.5, 0.5));
  EXPECT_DOUBLE_EQ(seconds_left(10.0, 0.5, 0.75).value(), 10.0);
  EXPECT_EQ(seconds_left(10.0, 0.0, 1.0).value(), 0.0);
  EXPECT_EQ(seconds_left(10.0, 0.0, 1.2).value(), 0.0) << "never less than nothing";
}

}  // namespace
}  // namespace rayloc::cli::calibration_progress_test
