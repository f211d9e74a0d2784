#include "daemon/cli/terminal/progress_line.h"

#include <string>

#include <gtest/gtest.h>

namespace rayloc::cli::progress_line_test {
namespace {

template <typename Show>
std::string shown(const Show& show) {
  ::testing::internal::CaptureStderr();
  ProgressLine line(false, true);
  show(line);
  return ::testing::internal::GetCapturedStderr();
}

TEST(ProgressLineText, ReportsProgressAndRemainingTime) {
  EXPECT_EQ(progress_line_text("joint", 19.6, "57 points"), "joint: about 20 s left, 57 points");
  EXPECT_EQ(progress_line_text("joint", std::nullopt, "57 points"), "joint: 57 points");
}

TEST(ProgressLineText, FitsIntoTheLine) {
  const std::string text = "joint: about 20 s left, 57 points, fit, step 12, loss 0.3121";
  for (const std::size_t columns : {1U, 20U, 40U}) {
    EXPECT_EQ(fitted_line(text, columns).size(), columns - 1);
  }
  EXPECT_EQ(fitted_line(text, 20), "joint: about 20 s l");
}

TEST(ProgressLineText, EstimatesTheRemainingTimeFromThisRunOnly) {
  EXPECT_FALSE(seconds_left(1.0, 0.0, 0.01));
  EXPECT_DOUBLE_EQ(seconds_left(10.0, 0.0, 0.25).value(), 30.0);
  // Gone on from half of the work: the first half took no time of this run.
  EXPECT_FALSE(seconds_left(1.0, 0.5, 0.5));
  EXPECT_DOUBLE_EQ(seconds_left(10.0, 0.5, 0.75).value(), 10.0);
  EXPECT_EQ(seconds_left(10.0, 0.0, 1.0).value(), 0.0);
  EXPECT_EQ(seconds_left(10.0, 0.0, 1.2).value(), 0.0) << "never less than nothing";
}

TEST(ProgressLine, WritesLinesForPrograms) {
  EXPECT_EQ(shown([](ProgressLine& line) {
              line.begin("train m3");
              line.show(0.02, "epoch 1");
            }),
            "progress 0.000 train m3 ...\nprogress 0.020 train m3: epoch 1\n");
  EXPECT_EQ(shown([](ProgressLine& line) { line.show_percent(0.416, "places"); }),
            "progress 0.416 places: 42 %\n");
}

TEST(ProgressLine, IsSilentWhereStandardErrorIsNoTerminal) {
  ::testing::internal::CaptureStderr();
  {
    ProgressLine line(false);
    line.begin("joint");
    line.show(0.5, "57 points");
    line.show_percent(0.5, "places");
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace rayloc::cli::progress_line_test
