#include "daemon/site/scene/scene_report_text.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/scenes.h"

namespace rayloc::scene_report_text_test {
namespace {

using ::testing::HasSubstr;

SceneSource closet() {
  return {"closet",
          "scene.xml",
          test::make_scene({{"shell", test::box_mesh({0, 0, 0}, {2, 1, 2.5})}}, test::kConcrete),
          {}};
}

TEST(SceneReportText, HasTheSizeMaterialsAndObjects) {
  const SceneSource source = closet();
  const std::string text = scene_report_text(source, inspect_scene(source));
  EXPECT_THAT(text, HasSubstr("closet: 2.000 x 1.000 x 2.500 m, 1 objects, 6 surfaces"));
  EXPECT_THAT(text, HasSubstr("concrete"));
  EXPECT_THAT(text, HasSubstr("closed"));
}

TEST(SceneReportText, ListsWarningsOrThatThereAreNone) {
  const SceneSource source = closet();
  SceneReport report;
  EXPECT_THAT(scene_report_text(source, report), HasSubstr("no warning\n"));
  report.warnings.push_back({"overlap", "two faces"});
  EXPECT_THAT(scene_report_text(source, report), HasSubstr("warning: two faces\n"));
}

TEST(SceneReportText, JsonIsOneLineAndSurvivesInvalidUtf8) {
  SceneSource source = closet();
  source.name = "closet\xff";
  const std::string text = scene_report_json(source, inspect_scene(source));
  EXPECT_EQ(text.find('\n'), text.size() - 1);
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["objects"][0]["name"], "shell");
  EXPECT_EQ(json["objects"][0]["form"], "closed");
  EXPECT_EQ(json["bounds"]["max"][0], 2.0);
}

}  // namespace
}  // namespace rayloc::scene_report_text_test
