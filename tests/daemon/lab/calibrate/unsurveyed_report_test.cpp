// The report of a calibration without a survey: its verdict for the plan, and for learned chains.
#include "daemon/lab/calibrate/unsurveyed/unsurveyed_report.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

namespace rayloc::unsurveyed_report_test {
namespace {

bool contains(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

UnsurveyedReport plan_of(int access_points) {
  UnsurveyedReport report;
  report.site = "office <3>";
  report.calibration_id = "c0ffee";
  report.needed = 24;
  for (int i = 1; i <= access_points; ++i) {
    report.access_points.push_back("ap" + std::to_string(i));
  }
  return report;
}

// The chains of the first ones are learned.
UnsurveyedReport chains_of(int access_points, int known) {
  UnsurveyedReport report = plan_of(access_points);
  report.bursts = 50;
  report.places = 7;
  report.chains.emplace();
  for (int i = 0; i < access_points; ++i) {
    const std::string& id = report.access_points[static_cast<std::size_t>(i)];
    if (i < known) {
      RechainedAccessPoint& learned = report.chains->access_points.emplace_back();
      learned.id = id;
      learned.learned_from = 41;
    } else {
      report.chains->refused.push_back({id, "its frames are too few"});
    }
  }
  return report;
}

TEST(UnsurveyedReport, StatesAnAccuracyOnlyWhereItWasMeasured) {
  EXPECT_TRUE(contains(expectation(plan_of(3)), "Plan only")) << expectation(plan_of(3));
  EXPECT_TRUE(contains(expectation(plan_of(3)), "expect 0.5 to 0.9 m"));
  EXPECT_TRUE(contains(expectation(plan_of(4)), "with 3 access points"));
  EXPECT_TRUE(contains(expectation(chains_of(3, 3)), "Chains only, the walls")) << "of all of them";
  EXPECT_TRUE(contains(expectation(chains_of(3, 3)), "expect 0.06 to 0.11 m"));
  EXPECT_TRUE(contains(expectation(chains_of(1, 1)), "expect 0.8 to 1.6 m"));
  EXPECT_TRUE(contains(expectation(chains_of(1, 1)), "9.0 m in a corridor"));
  EXPECT_TRUE(contains(expectation(chains_of(3, 1)), "Chains of 1 of 3 access points only"));
  for (const UnsurveyedReport& one : {plan_of(1), plan_of(2), chains_of(2, 2), chains_of(3, 2)}) {
    const std::string text = expectation(one);
    EXPECT_TRUE(contains(text, "was not measured")) << text;
    EXPECT_FALSE(contains(text, "expect ")) << text;
  }
}

TEST(UnsurveyedReport, ListsTheMostUsefulStepFirst) {
  EXPECT_TRUE(contains(advice(plan_of(3)).front(), "--unsurveyed --capture"));
  EXPECT_TRUE(contains(advice(plan_of(1)).front(), "Add access points"));
  const std::vector<std::string> unknown = advice(chains_of(3, 2));
  EXPECT_EQ(unknown.front(), "Learn the chains of ap3: its frames are too few.");
  EXPECT_EQ(unknown.size(), 2U) << "the recording that they need is that of the walls";
  EXPECT_TRUE(contains(advice(chains_of(3, 3)).front(), "7 bursts have a reliable position"));
  EXPECT_TRUE(contains(advice(chains_of(3, 3)).front(), "24"));
  UnsurveyedReport failed = chains_of(3, 3);
  failed.reasons = {"ap1 is explained less than before"};
  EXPECT_TRUE(contains(advice(failed).front(), failed.reasons.front()));
  for (const UnsurveyedReport& one : {plan_of(3), chains_of(3, 3), failed}) {
    EXPECT_TRUE(contains(advice(one).back(), "Survey points"));
  }
}

TEST(UnsurveyedReport, ThePageBeginsWithTheVerdict) {
  UnsurveyedReport failed = chains_of(3, 2);
  failed.reasons = {"ap1 is explained less than before"};
  for (const UnsurveyedReport& one : {plan_of(1), chains_of(3, 2), failed}) {
    const std::string html = to_html(one);
    pugi::xml_document page;
    const auto parsed = page.load_string(html.substr(html.find("<html")).c_str());
    ASSERT_TRUE(parsed) << parsed.description() << " at " << parsed.offset;
    const pugi::xml_node body = page.child("html").child("body");
    EXPECT_STREQ(body.child("p").child("strong").child_value(), expectation(one).c_str());
    std::vector<std::string> steps;
    for (const pugi::xml_node& step : body.child("ol").children("li")) {
      steps.emplace_back(step.child_value());
    }
    EXPECT_EQ(steps, advice(one));
    EXPECT_EQ(contains(html, "walls.html"), !one.reasons.empty());
    EXPECT_EQ(contains(html, "learned from 41 bursts"), one.chains.has_value());
    EXPECT_TRUE(contains(html, "unknown: "));
  }
}

TEST(UnsurveyedReport, ProgramsReadTheSame) {
  const UnsurveyedReport report = chains_of(3, 2);
  const auto json = to_json(report);
  EXPECT_EQ(json.at("verdict").at("expectation"), expectation(report));
  EXPECT_EQ(json.at("verdict").at("advice"), nlohmann::ordered_json(advice(report)));
  EXPECT_TRUE(json.at("verdict").at("success").get<bool>());
  EXPECT_EQ(json.at("calibration_id"), "c0ffee");
  EXPECT_EQ(json.at("calibrated"), nlohmann::ordered_json::array({"chains"}));
  EXPECT_EQ(json.at("access_points").size(), 2U);
  EXPECT_EQ(json.at("access_points").at(0).at("learned_from_bursts"), 41);
  EXPECT_EQ(json.at("refused").at(0).at("what"), "ap3");
  EXPECT_TRUE(to_json(plan_of(3)).at("calibrated").empty());
}

}  // namespace
}  // namespace rayloc::unsurveyed_report_test
