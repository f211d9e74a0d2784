#include "daemon/cli/calibration/fit_arguments.h"

#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::cli::fit_arguments_test {
namespace {

// The message of the refusal after a change of complete arguments; empty if they are accepted.
std::string refusal(const std::function<void(CalibrateArguments&)>& change) {
  CalibrateArguments arguments;
  arguments.site = "office";
  arguments.captures = {"ap1=survey.pcap"};
  arguments.points = "survey.csv";
  arguments.out = "office-calibrated";
  change(arguments);
  const auto checked = check_fit_arguments(arguments);
  if (checked) {
    return "";
  }
  EXPECT_EQ(checked.error().kind, ErrorKind::kUsage);
  return checked.error().message;
}

TEST(FitArguments, AcceptsTheDefaults) {
  EXPECT_EQ(refusal([](CalibrateArguments&) {}), "");
}

TEST(FitArguments, NamesTheOptionThatIsWrong) {
  using ::testing::HasSubstr;
  EXPECT_THAT(refusal([](auto& a) { a.points.clear(); }), HasSubstr("--points"));
  EXPECT_THAT(refusal([](auto& a) { a.holdout = 0.9; }), HasSubstr("--holdout"));
  EXPECT_THAT(refusal([](auto& a) { a.survey_error = 0.2; }), HasSubstr("--survey-error"));
  EXPECT_THAT(refusal([](auto& a) {
                a.resume = true;
                a.method = "paper";
              }),
              HasSubstr("--resume"));
}

}  // namespace
}  // namespace rayloc::cli::fit_arguments_test
