// Tests what a calibration writes to stderr: messages, results, chains.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/cli/calibration/calibration_summary.h"
#include "daemon/cli/calibration/chain_report.h"
#include "daemon/cli/calibration/terminal_observer.h"

namespace rayloc::cli::calibration_messages_test {
namespace {

template <typename Print>
std::string printed(const Print& print) {
  ::testing::internal::CaptureStderr();
  print();
  return ::testing::internal::GetCapturedStderr();
}

std::string messages(bool quiet) {
  return printed([&] {
    ProgressLine line(true);
    const FitObserver observer = terminal_observer(line, {"office", "out", quiet});
    observer.begin("joint");
    observer.step({});
    observer.note("a note");
    observer.warn("a warning");
    observer.verdict({{"a reason"}, {}, {}});
  });
}

TEST(TerminalObserver, PrintsMessagesInTheirOrder) {
  EXPECT_THAT(messages(false),
              ::testing::StartsWith("a note\na warning\nrayloc: office: a reason\n"));
}

TEST(TerminalObserver, PrintsOnlyWarningsForAQuietUser) {
  EXPECT_THAT(messages(true), ::testing::StartsWith("a warning\nrayloc: office: a reason\n"));
}

TEST(CalibrationStepText, HasPointsStageLossAndHeldOutFit) {
  CalibrationProgress progress{{"fit", 12, 0.31214, 0.8713}, 0.5, 57};
  EXPECT_EQ(step_text(progress), "57 points, fit, step 12, loss 0.3121, held-out 0.871");
  // Losses of the two methods are of different sizes.
  progress.step.loss = 0.00071234;
  EXPECT_THAT(step_text(progress), ::testing::HasSubstr("loss 0.0007123,"));
  progress.step.loss = 1234.567;
  EXPECT_THAT(step_text(progress), ::testing::HasSubstr("loss 1235,"));
}

TEST(TerminalObserver, WritesProgressForPrograms) {
  const std::string text = printed([] {
    ProgressLine line(false, true);
    const FitObserver observer = terminal_observer(line, {"office", "out", false});
    observer.begin("joint");
    observer.step({{"fit", 12, 0.31214, 0.8713}, 0.5, 57});
  });
  EXPECT_EQ(text,
            "progress 0.000 joint ...\nprogress 0.500 joint: 57 points, fit, step 12, loss 0.3121, "
            "held-out 0.871\n");
}

TEST(CalibrationResultText, NamesTheReportsOfARefusedSurvey) {
  CalibrationResult result;
  result.outcome = CalibrationOutcome::kFails;
  result.report.verdict.reasons = {"a reason"};
  result.is_site_written = false;
  const std::string text = printed([&] { print_result(result, {"office", "out", false}); });
  EXPECT_THAT(text, ::testing::StartsWith("rayloc: office: a reason\n"));
  EXPECT_THAT(text, ::testing::HasSubstr("rayloc: no site was written"));
  EXPECT_THAT(text, ::testing::HasSubstr("; out has its report. "));
}

TEST(CalibrationResultText, NamesTheStateAfterAStop) {
  CalibrationResult result;
  const auto text = [&](CalibrationInterruption stop) {
    result.interruption = stop;
    return printed([&] { print_result(result, {"office", "out", true}); });
  };
  EXPECT_EQ(text({false, true, true}),
            "interrupted: out holds the last good state; --resume goes on\n");
  EXPECT_EQ(text({true, false, false}),
            "interrupted: out holds the whole calibration, without the comparison\n");
  EXPECT_EQ(text({true, false, true}), "interrupted: out holds the whole calibration\n");
}

TEST(ChainReport, PrintsTheChangeOfEachChain) {
  RechainResult result;
  result.access_points = {
      {"ap1", 0, 3, false, 0.9123, 0.95, {{1, 0, {0.5, 10.0}, {0.25, -20.0}, {0.1, 1.5}}}},
      {"ap2", 40, 0, false, {}, {}, {}}};
  result.refused = {{"ap3", "no recording: keeps its gains"}};
  const std::string text = printed([&] { print_chains(result, false); });
  EXPECT_EQ(text,
            "ap1: 3 known places, fit 0.912 (0.950 when calibrated)\n"
            "  core 1 against 0: phase 10.0 -> -20.0 deg (sigma 1.5), gain 0.50 -> 0.25 dB\n"
            "ap2: learned from 40 bursts of devices\n");
  EXPECT_EQ(printed([&] { print_chains(result, true); }),
            "ap3: no recording: keeps its gains\n" + text);
}

}  // namespace
}  // namespace rayloc::cli::calibration_messages_test
