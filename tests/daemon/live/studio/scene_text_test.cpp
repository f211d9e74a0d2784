// A scene keeps what a person wrote in it; what is drawn is written as one would.
#include "daemon/live/studio/scene_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::scene_text_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kScene = R"(<?xml version="1.0" encoding="utf-8"?>
<!-- drawn by Zoë -->
<scene version="2.1.0">
    <bsdf type="itu-radio-material" id="mat-itu_brick">
        <string name="type" value="brick"/>
    </bsdf>
    <!-- not <shape> but a remark -->
    <shape type="ply" id="mesh-sofa">
        <string name="filename" value="meshes/sofa.ply"/>
        <ref id="mat-itu_brick" name="bsdf"/>
    </shape>
    <shape type="cube" id="mesh-table">  <!-- ours -->
        <transform name="to_world">
            <scale x="0.9" y="0.45" z="0.375"/>  <!-- half of it -->
            <translate x="2" y="1.5" z="0.375"/>
        </transform>
        <ref id="mat-itu_brick" name="bsdf"/>
    </shape>
</scene>
)";

class SceneTextTest : public ::testing::Test {
 protected:
  std::vector<DraftObject> objects_ = read_scene_text(kScene, "scene.xml").value();

  std::string edited() const {
    const auto text = edit_scene_text(kScene, "scene.xml", objects_);
    return text ? *text : "error: " + text.error().message;
  }
  static std::string with(std::string_view is, std::string_view wanted) {
    std::string text = kScene;
    const std::size_t at = text.find(is);
    EXPECT_NE(at, std::string::npos) << is;
    return text.replace(at, is.size(), wanted);
  }
};

TEST_F(SceneTextTest, ReadsBoxesAndLeavesMeshes) {
  ASSERT_EQ(objects_.size(), 2U);
  EXPECT_EQ(objects_[0].name, "sofa");
  EXPECT_EQ(objects_[0].form, DraftForm::kMesh);
  EXPECT_EQ(objects_[1].form, DraftForm::kBox);
  EXPECT_DOUBLE_EQ(objects_[1].size.x, 1.8);
  EXPECT_EQ(objects_[1].material, "itu_brick");
  EXPECT_THAT(scene_materials(kScene), ElementsAre("itu_brick"));
  EXPECT_EQ(edited(), kScene);
}

TEST_F(SceneTextTest, MovesRotatesAndResizesABoxInPlace) {
  objects_[1].centre.x = 2.5;
  EXPECT_EQ(edited(), with("x=\"2\" y=\"1.5\"", "x=\"2.5\" y=\"1.5\""));
  objects_[1].centre.x = 2.0;
  objects_[1].size.x = 1.0;
  EXPECT_EQ(edited(), with("x=\"0.9\"", "x=\"0.5\""));
  objects_[1].size.x = 1.8;
  objects_[1].yaw_deg = 20.0;
  EXPECT_EQ(edited(),
            with("            <translate",
                 "            <rotate z=\"1\" angle=\"20\"/>\n            <translate"));
}

TEST_F(SceneTextTest, MovesAMesh) {
  objects_[0].moved = {0.5, -1.0};
  const std::string text = edited();
  EXPECT_EQ(text,
            with("name=\"bsdf\"/>\n    </shape>",
                 "name=\"bsdf\"/>\n        <transform name=\"to_world\">\n"
                 "            <translate x=\"0.5\" y=\"-1\" z=\"0\"/>\n"
                 "        </transform>\n    </shape>"));
  auto again = read_scene_text(text, "scene.xml").value();
  again[0].moved = {0.25, 0.0};
  EXPECT_THAT(edit_scene_text(text, "scene.xml", again).value(),
              HasSubstr("<translate x=\"0.75\" y=\"-1\" z=\"0\"/>"));
}

TEST_F(SceneTextTest, RemovesAnObject) {
  objects_.erase(objects_.begin());
  const std::string all = kScene;
  const std::size_t begin = all.find("    <shape type=\"ply\"");
  EXPECT_EQ(edited(), all.substr(0, begin) + all.substr(all.find("    <shape type=\"cube\"")));
}

TEST_F(SceneTextTest, AddsFurnitureAndAWallWithAMaterial) {
  DraftObject box{.name = "desk", .material = "wood", .form = DraftForm::kBox};
  box.centre = {1, 1, 0.4};
  box.size = {1, 0.5, 0.8};
  DraftObject wall{.name = "partition", .material = "brick", .form = DraftForm::kWall};
  wall.from = {0, 0};
  wall.to = {0, 2};
  wall.height = 2.5;
  objects_.push_back(box);
  objects_.push_back(wall);
  const std::string text = edited();
  EXPECT_THAT(text,
              HasSubstr("    </bsdf>\n    <bsdf type=\"itu-radio-material\" id=\"mat-itu_wood\">"));
  EXPECT_THAT(text, HasSubstr("<scale x=\"0.5\" y=\"0.25\" z=\"0.4\"/>"));
  EXPECT_THAT(text, HasSubstr("    </shape>\n</scene>\n"));
  const auto again = read_scene_text(text, "scene.xml").value();
  ASSERT_EQ(again.size(), 4U);
  EXPECT_EQ(again[3].form, DraftForm::kWall);
  EXPECT_NEAR(again[3].to[1], 2.0, 1e-9);
  EXPECT_NEAR(again[3].to[0], 0.0, 1e-9);
  EXPECT_NEAR(again[3].bottom, 0.0, 1e-9);
}

TEST_F(SceneTextTest, RefusesInvalidObjects) {
  DraftObject box{.name = "a\"/><x", .material = "wood", .form = DraftForm::kBox};
  box.size = {1, 1, 1};
  objects_.push_back(box);
  EXPECT_THAT(edited(), HasSubstr("error: the object 'a\"/><x' needs a name"));
  objects_[2].name = "b";
  objects_[2].material = "\"/>";
  EXPECT_THAT(edited(), HasSubstr("error: there is no material"));
  objects_[2].material = "wood";
  objects_[2].size.z = 0.0;
  EXPECT_THAT(edited(), HasSubstr("a size of a millimetre or more"));
  EXPECT_THAT(edit_scene_text("<a", "scene.xml", {}).error().message, HasSubstr("scene.xml: "));
}

}  // namespace
}  // namespace rayloc::scene_text_test
