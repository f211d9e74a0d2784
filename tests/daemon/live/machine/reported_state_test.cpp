// Tests the findings of `rayloc doctor` from the answers of a raylocd.
#include "daemon/live/machine/reported_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace rayloc::reported_state_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Kind = Finding::Kind;

std::vector<std::string> lines_of(const std::vector<Finding>& findings) {
  std::vector<std::string> lines;
  for (const Finding& finding : findings) {
    lines.push_back((finding.kind == Kind::kProblem ? "problem " : "warning ") + finding.what);
  }
  return lines;
}

const nlohmann::json kReady = {{"reasons", {"source ap1 is silent", "the disk is full"}},
                               {"warnings", {"the clock differs", "people are not located"}}};

TEST(ReportedState, LeavesOutWhatDoctorFindsItself) {
  std::vector<Finding> findings{{Kind::kProblem, "the disk is full", ""}};
  add_readiness(kReady, true, findings);
  EXPECT_THAT(lines_of(findings),
              ElementsAre("problem the disk is full", "warning raylocd: people are not located"));
}

TEST(ReportedState, HasSourcesOnlyWhereTheyWereNotExamined) {
  std::vector<Finding> findings;
  add_readiness(kReady, false, findings);
  EXPECT_THAT(lines_of(findings),
              ElementsAre("problem raylocd: source ap1 is silent",
                          "problem raylocd: the disk is full",
                          "warning raylocd: people are not located"));
}

TEST(ReportedState, TakesAnAnswerWithoutLists) {
  std::vector<Finding> findings;
  add_readiness(nlohmann::json::object(), false, findings);
  EXPECT_TRUE(findings.empty());
}

TEST(ReportedState, ADaemonThatDoesNotAnswerIsNoFaultWithoutHttp) {
  EXPECT_EQ(silent_daemon(7, false).kind, Kind::kOk);
  EXPECT_EQ(silent_daemon(7, true).kind, Kind::kWarning);
  EXPECT_THAT(silent_daemon(7, true).what, HasSubstr("process 7"));
}

}  // namespace
}  // namespace rayloc::reported_state_test
