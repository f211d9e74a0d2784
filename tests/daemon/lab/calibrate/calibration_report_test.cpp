#include "daemon/lab/calibrate/report/calibration_report.h"

#include <algorithm>
#include <optional>
#include <string>

#include <gtest/gtest.h>
#include <pugixml.hpp>

#include "tests/daemon/lab/calibrate/sample_report.h"

namespace rayloc::calibration_report_test {
namespace {

std::string without_doctype(const std::string& html) { return html.substr(html.find("<html")); }

// All text of a page but its style.
std::string text_of(const pugi::xml_node& node) {
  std::string text;
  for (const pugi::xml_node& child : node.children()) {
    text += child.type() == pugi::node_pcdata ? child.value() + std::string(" ") : text_of(child);
  }
  return text;
}

struct Page {
  explicit Page(const CalibrationReport& report) : html(to_html(report)) {
    const auto parsed = document.load_string(without_doctype(html).c_str());
    EXPECT_TRUE(parsed) << parsed.description() << " at " << parsed.offset;
    text = text_of(document.child("html").child("body"));
  }
  bool contains(const std::string& words) const { return text.find(words) != std::string::npos; }

  std::string html;
  pugi::xml_document document;
  std::string text;
};

TEST(CalibrationReportJson, GivesTheMedianOfThePointsHeldOut) {
  const auto json = to_json(test::sample_report());
  const auto& fit = json.at("heldout").at("a");
  EXPECT_DOUBLE_EQ(fit.at("before"), 0.55);  // of 0.50 and 0.60; the others were fitted
  EXPECT_DOUBLE_EQ(fit.at("after"), 0.92);
  EXPECT_DOUBLE_EQ(fit.at("mean_after"), 0.92);
  EXPECT_DOUBLE_EQ(fit.at("quartiles_after").at(0), 0.91);
  EXPECT_DOUBLE_EQ(fit.at("quartiles_after").at(1), 0.93);
  EXPECT_EQ(fit.at("points"), 2);
  EXPECT_NE(json.at("heldout_is").get<std::string>().find("median"), std::string::npos);
}

// A method may look deeper into the room than a fix does.
TEST(CalibrationReportJson, SeparatesMethodCorrelationFromLocatedCorrelation) {
  const auto json = to_json(test::sample_report());
  EXPECT_DOUBLE_EQ(json.at("heldout").at("a").at("after_as_located"), 0.88);
  EXPECT_DOUBLE_EQ(json.at("heldout").at("a").at("quartiles_after_as_located").at(0), 0.87);
  EXPECT_DOUBLE_EQ(json.at("heldout").at("a").at("quartiles_after_as_located").at(1), 0.89);
  EXPECT_TRUE(json.at("heldout").at("b").at("after_as_located").is_null());
  EXPECT_EQ(json.at("methods").at("joint").at("rays").at("max_depth"), 4);
  EXPECT_TRUE(json.at("methods").at("joint").at("rays").at("transmission").get<bool>());
  EXPECT_FALSE(json.at("methods").at("paper").at("rays").at("transmission").get<bool>());
  EXPECT_EQ(json.at("rays_as_located").at("max_depth"), 2);
  const Page page(test::sample_report());
  EXPECT_TRUE(page.contains("0.880 (0.870 – 0.890)"));
  EXPECT_TRUE(page.contains("4 reflections and crossings"));
  EXPECT_TRUE(page.contains("2 reflections at edges of 0.1 m"));
}

TEST(CalibrationReportJson, IsNullWhereNothingWasHeldOut) {
  const auto json = to_json(test::sample_report());
  EXPECT_TRUE(json.at("heldout").at("c").at("after").is_null());
  EXPECT_EQ(json.at("heldout").at("c").at("points"), 0);
}

TEST(CalibrationReportJson, ListsParametersWithUnitsAndUnboundedOnesWithoutSigma) {
  const auto json = to_json(test::sample_report());
  const auto& wall = json.at("parameters").at(1);
  EXPECT_EQ(wall.at("name"), "west.+x.offset");
  EXPECT_EQ(wall.at("unit"), "m");
  EXPECT_DOUBLE_EQ(wall.at("value"), 0.012);
  EXPECT_DOUBLE_EQ(wall.at("prior"), 0.0);
  EXPECT_DOUBLE_EQ(wall.at("prior_sigma"), 0.01);
  EXPECT_DOUBLE_EQ(wall.at("sigma"), 0.001);
  EXPECT_TRUE(json.at("parameters").at(2).at("sigma").is_null());
  EXPECT_TRUE(json.at("parameters").at(2).at("prior_sigma").is_null());
}

TEST(CalibrationReportJson, ListsTheLargestChangesFirst) {
  const auto json = to_json(test::sample_report());
  EXPECT_EQ(json.at("moved").at(0).at("name"), "west.+x.offset");
  EXPECT_DOUBLE_EQ(json.at("moved").at(0).at("prior_sigmas"), 1.2);
  EXPECT_EQ(json.at("moved").at(2).at("caution"), "not bounded by the data");
}

TEST(CalibrationReportJson, HoldsMethodsSideBySide) {
  const auto json = to_json(test::sample_report());
  EXPECT_EQ(json.at("method"), "joint");
  EXPECT_DOUBLE_EQ(json.at("methods").at("joint").at("heldout").at("a").at("after"), 0.92);
  EXPECT_DOUBLE_EQ(json.at("methods").at("paper").at("heldout").at("a").at("after"), 0.71);
  const auto& step = json.at("methods").at("paper").at("history").at(1);
  EXPECT_EQ(step.at("stage"), "joint");
  EXPECT_EQ(step.at("iteration"), 1);
  EXPECT_DOUBLE_EQ(step.at("loss"), 8.0);
  EXPECT_DOUBLE_EQ(step.at("heldout"), 0.92);
}

TEST(CalibrationReportJson, KeepsFixesRefusalsAndFits) {
  const auto json = to_json(test::sample_report());
  EXPECT_EQ(json.at("heldout_fixes").at(1).at("within_accuracy_95"), 2);
  EXPECT_EQ(json.at("refused").at(0).at("what"), "points.csv:9 a");
  ASSERT_EQ(json.at("fits").size(), 5U);
  EXPECT_EQ(json.at("fits").at(4).at("ap"), "b");
  EXPECT_TRUE(json.at("fits").at(4).at("held_out").get<bool>());
  EXPECT_DOUBLE_EQ(json.at("peak_memory_mib"), 300.0);
}

TEST(CalibrationReportHtml, IsWellFormedAndComplete) {
  const Page page(test::sample_report());
  for (const char* heading : {"Methods",
                              "Course of the fit",
                              "Fit of the points held out",
                              "Changes to the plan",
                              "Where the room is explained",
                              "Refused"}) {
    EXPECT_TRUE(page.contains(heading)) << heading;
  }
  const auto pictures = page.document.select_nodes("//svg");
  EXPECT_EQ(pictures.size(), 2U + 1U + 3U + 1U + 3U);  // loss, held out, fits, plan, residuals
}

TEST(CalibrationReportHtml, ShowsTheFigures) {
  const Page page(test::sample_report());
  EXPECT_TRUE(page.contains("0.920 (0.910 – 0.930)"));  // joint, a
  EXPECT_TRUE(page.contains("0.710 (0.705 – 0.715)"));  // paper, a
  EXPECT_TRUE(page.contains("median error 0.250 m, 2 within the stated"));
  EXPECT_TRUE(page.contains("+12 mm"));
  EXPECT_TRUE(page.contains("12 ± 1 mm"));
  EXPECT_TRUE(page.contains("300 MiB"));
}

// An error of 0.000 m would look like the best of all calibrations.
TEST(CalibrationReport, StatesNoErrorWhereNothingWasFixed) {
  CalibrationReport report = test::sample_report();
  report.fixes.back() = {0.6, 0.005, 2, 0, 0, std::nullopt, 0.0};
  EXPECT_TRUE(to_json(report).at("heldout_fixes").at(1).at("median_error_m").is_null());
  EXPECT_TRUE(Page(report).contains("Held-out fixes: 0 of 2 points (likelihood exponent 0.6)."));
  report.fixes.back().points = 0;
  EXPECT_TRUE(Page(report).contains("no point was held out"));
}

// The paper's loss wanders, and its rays explain another share of the floor plan.
TEST(CalibrationReportHtml, ShowsTheStartAndTheKeptLossOfEachMethod) {
  CalibrationReport report = test::sample_report();
  RoomCalibration& paper = report.methods.back().calibration;
  paper.points[1].before = 0.41;
  paper.points[2].before = 0.43;
  paper.history = {{"paper", 0, 1.5, 0.4}, {"paper", 1, 1.125, 0.7}, {"paper", 2, 1.25, 0.6}};
  const Page page(report);
  EXPECT_TRUE(page.contains("8 (8)"));
  EXPECT_TRUE(page.contains("1.25 (1.125)"));
  EXPECT_TRUE(page.contains("0.550"));
  EXPECT_TRUE(page.contains("0.420"));
}

TEST(CalibrationReportHtml, ReadsAnglesInDegrees) {
  CalibrationReport report = test::sample_report();
  report.methods.front().calibration.parameters.push_back(
      {{141.0, 146.0, 4.9}, parse_parameter_id("a.core3/core2.phase"), "deg", 17.0});
  const Page page(report);
  EXPECT_TRUE(page.contains("141 ± 4.9 °"));
  EXPECT_FALSE(page.contains("deg"));
}

TEST(CalibrationReportHtml, EscapesNames) {
  const Page page(test::sample_report());
  EXPECT_TRUE(page.contains("Calibration of office <3> & lab"));
  EXPECT_TRUE(page.contains("no frames at \"that\" time <1 s>"));
  EXPECT_EQ(page.html.find("<3>"), std::string::npos);
}

TEST(CalibrationReportHtml, LoadsNothingAndRunsNothing) {
  const Page page(test::sample_report());
  EXPECT_TRUE(page.document.select_nodes("//script|//link|//img|//iframe").empty());
  EXPECT_TRUE(page.document.select_nodes("//@src|//@href|//@onload").empty());
  EXPECT_EQ(page.html.find("url("), std::string::npos);
  EXPECT_EQ(page.html.find("@import"), std::string::npos);
  EXPECT_NE(page.html.find("prefers-color-scheme: dark"), std::string::npos);
}

TEST(CalibrationReportHtml, FoldsLongTables) {
  CalibrationReport report = test::sample_report();
  auto& parameters = report.methods.front().calibration.parameters;
  while (parameters.size() < 60) {
    parameters.push_back(parameters.front());
  }
  const Page page(report);
  EXPECT_EQ(page.document.select_nodes("//details//tbody/tr").size(), 35U);
  EXPECT_TRUE(page.contains("35 more"));
}

TEST(CalibrationReport, HoldsACalibrationWithoutPointsOrHistory) {
  CalibrationReport report = test::sample_report();
  report.positions.clear();
  report.located.clear();
  report.held_out.clear();
  report.fixes.clear();
  report.refused.clear();
  report.peak_memory_bytes = 0;
  report.methods.resize(1);
  report.methods.front().calibration.points.clear();
  report.methods.front().calibration.history.clear();
  report.methods.front().calibration.parameters.clear();
  const auto json = to_json(report);
  EXPECT_TRUE(json.at("heldout").at("a").at("before").is_null());
  EXPECT_TRUE(json.at("methods").at("joint").at("history").empty());
  EXPECT_TRUE(json.at("peak_memory_mib").is_null());
  const Page page(report);
  EXPECT_TRUE(page.contains("no data"));
  EXPECT_TRUE(page.contains("Nothing was refused."));
  EXPECT_TRUE(page.contains("No parameter was fitted."));
}

TEST(CalibrationReport, ReportsAnInterruptedRun) {
  CalibrationReport report = test::sample_report();
  EXPECT_FALSE(Page(report).contains("interrupted"));
  report.methods.front().calibration.interrupted = true;
  EXPECT_TRUE(Page(report).contains("interrupted"));
  EXPECT_TRUE(to_json(report).at("methods").at("joint").at("interrupted").get<bool>());
}

}  // namespace
}  // namespace rayloc::calibration_report_test
