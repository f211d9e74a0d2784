// A folder on the disk: what is written passes the checks, the old files stay, and nothing else is
// touched.
#include "daemon/live/studio/site_editor.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/live/studio/walked_survey.h"
#include "daemon/site/survey/points_csv.h"
#include "tests/support/test_paths.h"

namespace rayloc::site_editor_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

class SiteEditorTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::copy(fs::path(test::data_path()) / "sites" / "meeting_room",
             folder_,
             fs::copy_options::recursive);
  }
  void TearDown() override { fs::remove_all(folder_); }

  nlohmann::ordered_json draft() const { return SiteEditor(folder_).state().value()["draft"]; }

  const fs::path folder_ =
      fs::temp_directory_path() / ("rayloc-editor-" + std::to_string(::getpid()));
};

TEST_F(SiteEditorTest, ShowsAFolderThatIsEmpty) {
  fs::remove_all(folder_);
  fs::create_directories(folder_);
  const auto state = SiteEditor(folder_).state();
  ASSERT_TRUE(state) << state.error().message;
  EXPECT_TRUE((*state)["empty"]);
}

TEST_F(SiteEditorTest, WritesOnlyChangesAndKeepsABackup) {
  const std::string before = read(folder_ / "site.toml");
  const std::string scene = read(folder_ / "scene.xml");
  auto wanted = draft();
  wanted["zones"].push_back({{"was", ""}, {"name", "desk"}, {"polygon", {{0, 0}, {1, 0}, {1, 1}}}});
  const auto saved = SiteEditor(folder_).save(wanted.dump());
  ASSERT_TRUE(saved) << saved.error().message;
  EXPECT_EQ(read(folder_ / "site.toml"),
            before + "\n[[zone]]\nname = \"desk\"\npolygon = [[0, 0], [1, 0], [1, 1]]\n");
  EXPECT_EQ(read(folder_ / "site.toml.bak"), before);
  EXPECT_EQ(read(folder_ / "scene.xml"), scene);
  EXPECT_FALSE(fs::exists(folder_ / "scene.xml.bak"));
}

TEST_F(SiteEditorTest, WritesFurnitureIntoTheScene) {
  auto wanted = draft();
  wanted["objects"].push_back({{"was", ""},
                               {"name", "crate"},
                               {"material", "wood"},
                               {"form", "box"},
                               {"centre", {0.2, 1.0, 0.3}},
                               {"size", {0.5, 0.4, 0.6}},
                               {"yaw_deg", 10}});
  const auto saved = SiteEditor(folder_).save(wanted.dump());
  ASSERT_TRUE(saved) << saved.error().message;
  EXPECT_THAT(read(folder_ / "scene.xml"), HasSubstr("id=\"mesh-crate\""));
  const auto state = SiteEditor(folder_).state().value();
  EXPECT_EQ(state["draft"]["objects"].back()["name"], "crate");
  EXPECT_EQ(state["draft"]["objects"].back()["form"], "box");
}

TEST_F(SiteEditorTest, WritesNothingThatTheCheckRefuses) {
  const std::string before = read(folder_ / "site.toml");
  auto wanted = draft();
  wanted["zones"].push_back(
      {{"was", ""}, {"name", "bow"}, {"polygon", {{0, 0}, {1, 1}, {1, 0}, {0, 1}}}});
  EXPECT_THAT(SiteEditor(folder_).save(wanted.dump()).error().message, HasSubstr("crosses itself"));
  wanted["zones"] = nlohmann::json::array();
  wanted["access_points"] = nlohmann::json::array();
  EXPECT_THAT(SiteEditor(folder_).save(wanted.dump()).error().message, HasSubstr("access_point"));
  EXPECT_EQ(read(folder_ / "site.toml"), before);
  EXPECT_FALSE(fs::exists(folder_ / "site.toml.bak"));
}

TEST_F(SiteEditorTest, RefusesToOverwriteForeignEdits) {
  const auto wanted = draft();
  std::ofstream(folder_ / "site.toml", std::ios::app) << "# by hand\n";
  EXPECT_THAT(SiteEditor(folder_).save(wanted.dump()).error().message,
              HasSubstr("have changed since"));
  EXPECT_THAT(read(folder_ / "site.toml"), HasSubstr("# by hand"));
}

TEST_F(SiteEditorTest, WritesNoSceneOutsideOfTheFolder) {
  const fs::path other = folder_ / "site";
  fs::create_directories(other);
  std::string text = read(folder_ / "site.toml");
  text.replace(text.find("scene.xml"), 9, "../scene.xml");
  std::ofstream(other / "site.toml") << text;
  auto wanted = SiteEditor(other).state().value()["draft"];
  wanted["objects"].erase(wanted["objects"].end() - 1);
  EXPECT_THAT(SiteEditor(other).save(wanted.dump()).error().message,
              HasSubstr("not in the folder of the site"));
}

// A calibration is of one scene: another one would keep raylocd from starting.
TEST_F(SiteEditorTest, LeavesTheSceneOfACalibrationAlone) {
  std::ofstream(folder_ / "site.toml", std::ios::app)
      << "\n[calibration]\nfile = \"calibration.toml\"\n";
  std::ofstream(folder_ / "calibration.toml") << "format = 2\n";
  const auto refused = SiteEditor(folder_).save(draft().dump());
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("calibration.toml"));
  EXPECT_THAT(refused.error().message, HasSubstr("Draw in the one that it was made from"));
}

TEST_F(SiteEditorTest, WalkedPointsAreThoseThatCalibrateReads) {
  std::uint64_t frames = 5;
  const fs::path file = folder_ / "survey.csv";
  WalkedSurvey survey(file, [&] { return WalkedSurvey::Frames{{"ap1", frames}}; });
  EXPECT_FALSE(survey.keep());
  ASSERT_TRUE(survey.begin_stay({0.5, 0.25, 1.2}));
  EXPECT_THAT(survey.keep().error().message, HasSubstr("no access point has received"));
  frames += 21;
  EXPECT_EQ(survey.state().value()["standing"]["frames"]["ap1"], 21);
  ASSERT_TRUE(survey.keep());
  const auto points = load_points_csv(file);
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 1U);
  EXPECT_DOUBLE_EQ(points->front().position.y, 0.25);
  EXPECT_FALSE(survey.state().value().contains("standing"));
}

}  // namespace
}  // namespace rayloc::site_editor_test
