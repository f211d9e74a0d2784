#include "daemon/lab/experiment/experiment_report.h"

#include <algorithm>
#include <variant>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

namespace rayloc::experiment_report_test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kFile = R"(name = "A < B"
[defaults]
room = "a.toml"
[[study]]
name = "s, t"
claim = "x & y"
boxes = [1, 2]
method = ["rayloc", "paper"]
)";

ConditionResult result_of(const Condition& condition, double error) {
  ConditionResult result;
  result.condition = condition;
  for (int i = 1; i <= 3; ++i) {
    PointResult point;
    point.error = error * i;
    result.points.push_back(point);
  }
  result.statistics = compute_statistics(result.points, Controls{{1, 1, 1}, {}}, {50, 1, 1});
  return result;
}

class ExperimentReport : public ::testing::Test {
 protected:
  ExperimentReport() : experiment_(*parse_experiment(kFile, "e.toml")) {
    StudyResult& result = results_.emplace_back();
    result.study = &experiment_.studies.front();
    double error = 0.1;
    for (const Condition& condition : result.study->conditions) {
      result.conditions.push_back(result_of(condition, error));
      error += 0.1;
    }
  }
  Experiment experiment_;
  std::vector<StudyResult> results_;
};

TEST_F(ExperimentReport, JsonStatesEveryKeyAndFigure) {
  const auto json = nlohmann::json::parse(experiment_json(experiment_, results_));
  EXPECT_EQ(json["name"], "A < B");
  const auto& study = json["studies"][0];
  EXPECT_EQ(study["claim"], "x & y");
  EXPECT_EQ(study["over"], "boxes");
  ASSERT_EQ(study["conditions"].size(), 4U);
  const auto& second = study["conditions"][1];
  EXPECT_EQ(second["values"]["method"], "paper");
  EXPECT_EQ(second["values"]["paper.alpha"], "0.2");
  EXPECT_NEAR(second["statistics"]["median_m"], 0.4, 1e-12);
  EXPECT_TRUE(second["statistics"]["coverage_95"].is_null());  // not stated
}

TEST_F(ExperimentReport, CsvHasARowForEachConditionAndAsManyCellsInEach) {
  const std::string csv = experiment_csv(results_);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  const auto cells = [](const std::string& line) {
    return std::count(line.begin(), line.end(), ',');
  };
  const std::string header = csv.substr(0, csv.find('\n'));
  for (std::size_t at = 0; at < csv.size();) {
    const std::size_t end = csv.find('\n', at);
    EXPECT_EQ(cells(csv.substr(at, end - at)), cells(header));
    at = end + 1;
  }
  EXPECT_THAT(header, HasSubstr(",median_m,median_m_lower,median_m_upper,"));
  EXPECT_THAT(csv, HasSubstr("\ns; t,a,device,1,"));
}

TEST_F(ExperimentReport, ThePageIsWellFormedAndShowsTheClaim) {
  const std::string html = experiment_html(experiment_, results_);
  pugi::xml_document page;
  EXPECT_TRUE(page.load_string(html.c_str()));
  EXPECT_THAT(html, HasSubstr("x &amp; y"));
  EXPECT_THAT(html, HasSubstr("do not state the accuracy in a real room"));
  EXPECT_THAT(html, HasSubstr("<svg"));
}

TEST_F(ExperimentReport, ChartsHaveACurveForEachOtherAxis) {
  const auto drawings = draw_study(results_.front());
  ASSERT_EQ(drawings.size(), 3U);  // median, share below 0.5 m, distributions
  const auto has_text = [](const draw::Drawing& drawing, const std::string& text) {
    return std::any_of(drawing.shapes.begin(), drawing.shapes.end(), [&](const draw::Shape& shape) {
      const auto* words = std::get_if<draw::Text>(&shape);
      return words != nullptr && words->text == text;
    });
  };
  EXPECT_TRUE(has_text(drawings[0], "method rayloc"));
  EXPECT_TRUE(has_text(drawings[0], "method paper"));
  EXPECT_TRUE(has_text(drawings[0], "boxes"));
  EXPECT_TRUE(has_text(drawings[2], "boxes 1, method rayloc"));
}

}  // namespace
}  // namespace rayloc::experiment_report_test
