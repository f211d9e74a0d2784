// Tests the verdict on a calibration: a success, or the reasons why it is none.
#include "daemon/lab/calibrate/report/calibration_verdict.h"

#include <string>

#include <gtest/gtest.h>

#include "daemon/lab/calibrate/report/calibration_report.h"
#include "daemon/lab/calibrate/report/expectation.h"
#include "tests/daemon/lab/calibrate/sample_report.h"

namespace rayloc::calibration_verdict_test {
namespace {

// Twelve points held out at the first access point, three of them located.
CalibrationReport report_with(double before, double after, std::size_t fixes) {
  CalibrationReport report = test::sample_report();
  auto& points = report.methods.front().calibration.points;
  points = {{0, 0, 0.1, 0.9}};
  report.held_out = {false};
  report.positions = {{0.1, 0.2, 1.2}};
  report.located.clear();
  for (std::size_t i = 1; i <= kMinPairs; ++i) {
    points.push_back({i, 0, before, after});
    report.held_out.push_back(true);
    report.positions.push_back({0.05 * static_cast<double>(i), 0.2, 1.2});
  }
  report.methods.resize(1);
  report.fixes.back().points = 3;
  report.fixes.back().fixes = fixes;
  return report;
}

CalibrationVerdict judged(const CalibrationReport& report) {
  CalibrationVerdict verdict;
  judge_held_out(report, verdict);
  return verdict;
}

TriedMistake mistake(TriedMistake::Kind kind, double explained) {
  TriedMistake one{kind, "a thing", "the remedy", "the message", 0.2, explained, 5.0, 9.0};
  one.gained = 10.0 * (explained - 0.2);
  return one;
}

TEST(Field, CalibrationVerdictIsASuccessWhereMoreIsExplained) {
  EXPECT_TRUE(judged(report_with(0.3, 0.9, 3)).is_success());
  EXPECT_EQ(to_text(judged(report_with(0.3, 0.9, 3))), "");
}

TEST(Field, CalibrationVerdictNamesTheAccessPointThatExplainsLess) {
  const CalibrationVerdict verdict = judged(report_with(0.769, 0.371, 3));
  ASSERT_EQ(verdict.reasons.size(), 1U);
  EXPECT_NE(verdict.reasons.front().find("access point 'a'"), std::string::npos);
  EXPECT_NE(verdict.reasons.front().find("(0.371, median"), std::string::npos);
  EXPECT_NE(verdict.reasons.front().find("(0.769)"), std::string::npos);
}

TEST(Field, CalibrationVerdictFailsWhereHalfOfThePointsHaveNoFix) {
  EXPECT_TRUE(judged(report_with(0.3, 0.35, 2)).is_success());
  const CalibrationVerdict verdict = judged(report_with(0.3, 0.35, 1));
  ASSERT_EQ(verdict.reasons.size(), 1U);
  EXPECT_NE(verdict.reasons.front().find("2 of the 3 points held out have no fix"),
            std::string::npos);
}

TEST(Field, CalibrationVerdictIgnoresFewPointsAndInterruptedRuns) {
  CalibrationReport report = report_with(0.7, 0.3, 0);
  report.methods.front().calibration.interrupted = true;
  EXPECT_TRUE(judged(report).is_success());
  report = report_with(0.7, 0.3, 0);
  report.held_out.back() = false;
  report.fixes.back().points = 2;
  EXPECT_TRUE(judged(report).is_success());
}

TEST(Field, CalibrationVerdictListsTheTriedMistakes) {
  CalibrationVerdict verdict = judged(report_with(0.7, 0.3, 3));
  verdict.tried = {mistake(TriedMistake::Kind::kArray, 0.21)};
  add_carriers({mistake(TriedMistake::Kind::kCarrier, 0.22)}, verdict);
  EXPECT_EQ(verdict.reasons.size(), 1U) << "two hundredths are none of a tenth of what is left";
  EXPECT_TRUE(verdict.found.empty());
  EXPECT_NE(to_text(verdict).find("none of 2 usual mistakes"), std::string::npos);
  EXPECT_NE(to_text(verdict).find("(mean correlation 0.22, as stated 0.20)"), std::string::npos);
  add_carriers({mistake(TriedMistake::Kind::kCarrier, 0.8)}, verdict);
  ASSERT_EQ(verdict.found.size(), 1U);
  EXPECT_EQ(verdict.reasons.back(), "the message");
}

// Both reports, JSON and HTML, contain the verdict and its reasons.
TEST(Field, CalibrationVerdictAppearsInBothReports) {
  CalibrationReport report = report_with(0.7, 0.3, 3);
  EXPECT_TRUE(to_json(report).at("verdict").at("success"));
  EXPECT_EQ(to_html(report).find("This calibration is no success"), std::string::npos);
  report.verdict = verdict_of_inputs({{}, {mistake(TriedMistake::Kind::kArray, 0.8)}, {}});
  const auto json = to_json(report).at("verdict");
  EXPECT_FALSE(json.at("success"));
  EXPECT_EQ(json.at("reasons").at(0), "the message");
  EXPECT_EQ(json.at("explained_by").at(0).at("change"), "the remedy");
  EXPECT_DOUBLE_EQ(json.at("explained_by").at(0).at("correlation"), 0.8);
  EXPECT_NE(to_html(report).find("This calibration is no success"), std::string::npos);
  EXPECT_NE(to_html(report).find("the message"), std::string::npos);
}

// The report begins with the expected accuracy, for a reader who reads no further.
TEST(Expectation, ReportsTheExpectedAccuracyOfASite) {
  CalibrationReport report = report_with(0.3, 0.9, 3);
  report.fixes.back().median_error_m = 0.041;
  EXPECT_EQ(
      expectation(report),
      "Good: expect 4.1 cm with 1 access point (median of 3 points held out, 3 of them with a "
      "fix).");
  EXPECT_EQ(advice(report).size(), 1U) << "one access point";
  EXPECT_NE(to_html(report).find("<strong>Good: expect 4.1 cm"), std::string::npos);
  EXPECT_EQ(to_json(report).at("verdict").at("expectation"), expectation(report));
  report.fixes.back().median_error_m = 0.3;
  EXPECT_EQ(expectation(report).rfind("Usable: expect 30 cm", 0), 0U);
  EXPECT_EQ(advice(report).size(), 2U) << "one access point, and few points";
  report.fixes.back().median_error_m = 1.2;
  EXPECT_EQ(expectation(report).rfind("Doubtful: expect 1.2 m", 0), 0U);
  report.fixes.back().median_error_m.reset();
  EXPECT_EQ(expectation(report), "Doubtful: none of the 3 points held out has a fix.");
  report.fixes.back().points = 0;
  EXPECT_EQ(expectation(report), "Accuracy unknown: no point was held out.");
  report.verdict.reasons = {"it was raining"};
  EXPECT_EQ(expectation(report), "No success: it was raining");
}

TEST(Expectation, NamesTheAccessPointThatIsBehindTheOthers) {
  CalibrationReport report = report_with(0.3, 0.92, 3);
  report.fixes.back().median_error_m = 0.2;
  auto& points = report.methods.front().calibration.points;
  for (std::size_t i = 1; i <= kMinPairs; ++i) {
    points.push_back({i, 1, 0.2, 0.55});
  }
  TriedMistake rotated = mistake(TriedMistake::Kind::kArray, 0.22);
  rotated.what = "access point 'b' rotated by 180 degrees";
  rotated.significance = 1.4;
  report.verdict.tried = {rotated};
  EXPECT_EQ(expectation(report),
            "Usable: expect 20 cm with 2 access points (median of 3 points held out, 3 of them "
            "with a fix); b is doubtful, it explains 55 % of the CSI it received (access point 'b' "
            "rotated "
            "by 180 degrees?).");
  EXPECT_EQ(advice(report).front().rfind("Check b:", 0), 0U);
}

TEST(Expectation, AdvisesToMeasureThePointsWhereTheirPlacesLimitIt) {
  CalibrationReport report = report_with(0.3, 0.6, 3);
  report.survey_error = 0.005;
  EXPECT_EQ(advice(report).size(), 2U);
  for (PointFit& fit : report.methods.front().calibration.points) {
    fit.placed = 0.9;
  }
  ASSERT_EQ(advice(report).size(), 3U);
  EXPECT_NE(advice(report).front().find("state one above 0.5 cm"), std::string::npos);
}

}  // namespace
}  // namespace rayloc::calibration_verdict_test
