#include "engine/scene/read/load_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <string>

#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"

namespace rayloc::load_scene_test {
namespace {

const std::string kTriangle =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

SceneOptions options() { return {test::kCarrier, {}}; }

// A scene of one shape, with the given <bsdf> and inside of the <shape>.
std::string scene_of(const std::string& bsdf, const std::string& shape) {
  return "<scene version='2.1.0'>\n" + bsdf + "\n" + shape + "\n</scene>\n";
}
const std::string kConcreteBsdf = "<bsdf type='diffuse' id='mat-itu_concrete'/>";
const std::string kShape =
    "<shape type='ply' id='mesh-floor'><string name='filename' value='floor.ply'/>"
    "<ref id='mat-itu_concrete' name='bsdf'/></shape>";

Expected<Scene> parse(const std::string& xml,
                      const SceneOptions& scene_options = options(),
                      const std::string& mesh = kTriangle) {
  return parse_scene(xml, "scene.xml", scene_options, [&](const std::string& name) {
    return name == "missing.ply" ? Expected<std::string>(bad_input(name + " does not exist"))
                                 : mesh;
  });
}

std::string error_of(const Expected<Scene>& scene) {
  return scene ? "(no error)" : scene.error().message;
}

TEST(LoadScene, MeetingRoomIsReadWhole) {
  const auto scene = load_scene(test::data_path("/sites/meeting_room/scene.xml"), options());
  ASSERT_TRUE(scene) << error_of(scene);
  EXPECT_EQ(scene->objects().size(), 19U);
  EXPECT_EQ(scene->surfaces().size(), 114U);
  EXPECT_EQ(scene->triangle_count(), 228U);
  EXPECT_EQ(scene->dropped_triangles(), 0U);
  EXPECT_EQ(scene->materials().size(), 6U);
  EXPECT_EQ(scene->objects()[0].name, "floor");
  EXPECT_EQ(scene->material_of(0).name, "concrete");
  EXPECT_EQ(scene->material_of(0).thickness, kDefaultThickness);
  EXPECT_NEAR(scene->bounds_min().x, -1.885, 1e-6);
  EXPECT_NEAR(scene->bounds_max().z, 2.82, 1e-6);
}

TEST(LoadScene, OverridesReplaceOnlyTheirOwnValues) {
  SceneOptions changed = options();
  changed.materials["concrete"].thickness = 0.3;
  changed.materials["concrete"].conductivity = 0.05;
  const auto scene = parse(scene_of(kConcreteBsdf, kShape), changed);
  ASSERT_TRUE(scene) << error_of(scene);
  EXPECT_EQ(scene->materials()[0], (RadioMaterial{"concrete", 5.24, 0.05, 0.3}));
}

TEST(LoadScene, OverrideMakesAMaterialOfAnyBsdf) {
  SceneOptions changed = options();
  changed.materials["paint"] = {2.5, 0.01, std::nullopt};
  const auto scene =
      parse(scene_of("<bsdf type='diffuse' id='mat-paint'/>",
                     "<shape type='rectangle'><ref id='mat-paint' name='bsdf'/></shape>"),
            changed);
  ASSERT_TRUE(scene) << error_of(scene);
  EXPECT_EQ(scene->materials()[0], (RadioMaterial{"paint", 2.5, 0.01, 0.1}));
}

TEST(LoadScene, RadioMaterialsAreRead) {
  const auto itu = parse(
      scene_of("<bsdf type='itu-radio-material' id='mat-outer'><string name='type' value='brick'/>"
               "<float name='thickness' value='0.24'/></bsdf>",
               "<shape type='cube'><ref id='mat-outer' name='bsdf'/></shape>"));
  ASSERT_TRUE(itu) << error_of(itu);
  EXPECT_EQ(itu->materials()[0].name, "outer");
  EXPECT_EQ(itu->materials()[0].relative_permittivity, 3.91);
  EXPECT_EQ(itu->materials()[0].thickness, 0.24);

  const auto custom =
      parse(scene_of("<bsdf type='twosided' id='custom'><bsdf type='radio-material'>"
                     "<float name='relative_permittivity' value='4.5'/><float name='conductivity' "
                     "value='0.02'/><float name='thickness' value='0.05'/></bsdf></bsdf>",
                     "<shape type='cube'><ref id='custom' name='bsdf'/></shape>"));
  ASSERT_TRUE(custom) << error_of(custom);
  EXPECT_EQ(custom->materials()[0], (RadioMaterial{"custom", 4.5, 0.02, 0.05}));
}

TEST(LoadScene, BsdfInsideAShapeIsRead) {
  const auto scene = parse(
      scene_of("", "<shape type='cube' id='c'><bsdf type='diffuse' id='itu_metal'/></shape>"));
  ASSERT_TRUE(scene) << error_of(scene);
  EXPECT_EQ(scene->materials()[0].name, "metal");
  EXPECT_EQ(scene->objects()[0].name, "c");
}

TEST(LoadScene, TransformsApplyInTheOrderWritten) {
  const auto scene =
      parse(scene_of(kConcreteBsdf,
                     "<shape type='cube'><transform name='to_world'><scale x='2' y='1' z='0.5'/>"
                     "<rotate z='1' angle='90'/><translate value='10 20 30'/>"
                     "<matrix value='1 0 0 0  0 1 0 0  0 0 1 0.5  0 0 0 1'/></transform>"
                     "<ref id='mat-itu_concrete' name='bsdf'/></shape>"));
  ASSERT_TRUE(scene) << error_of(scene);
  EXPECT_NEAR(norm(scene->bounds_min() - Vec3d{9, 18, 30}), 0.0, 1e-12);
  EXPECT_NEAR(norm(scene->bounds_max() - Vec3d{11, 22, 31}), 0.0, 1e-12);
}

TEST(LoadScene, EachMistakeHasItsMessage) {
  const std::map<std::string, std::string> cases{
      {"", "scene.xml:1:1: this is not well-formed XML: No document element found"},
      {"<scene>\n  <shape", "scene.xml:2:8: this is not well-formed XML"},
      {"<room/>", "scene.xml:1:1: the file has no <scene> element"},
      {"<scene>\n</scene>", "scene.xml:1:1: the scene has no <shape>; a room needs at least one"},
      {"<scene><include filename='x'/></scene>", "scene.xml:1:8: <include> is not supported"},
      {scene_of(kConcreteBsdf, "  <shape type='sphere' id='ball'/>"),
       "scene.xml:3:3: shape 'ball' has type 'sphere'; ply, obj, cube and rectangle are supported"},
      {scene_of(kConcreteBsdf, "<shape type='ply' id='mesh-a'/>"),
       "scene.xml:3:1: shape 'a' has no <string name="},
      {scene_of(kConcreteBsdf, "<shape type='cube'/>"),
       "scene.xml:3:1: shape 'shape0' has no material"},
      {scene_of(kConcreteBsdf,
                "<shape type='cube'><ref id='mat-itu_concret' name='bsdf'/></shape>"),
       "there is no <bsdf> with the id 'mat-itu_concret'; did you mean 'mat-itu_concrete'?"},
      {scene_of("<bsdf type='diffuse' id='mat-itu_concret'/>",
                "<shape type='cube'><ref id='mat-itu_concret' name='bsdf'/></shape>"),
       "scene.xml:2:1: material 'concret': ITU-R P.2040-4 has no material 'concret'; did you mean "
       "'concrete'?"},
      {scene_of("<bsdf type='diffuse' id='grey'/>",
                "<shape type='cube'><ref id='grey' name='bsdf'/></shape>"),
       "material 'grey': the <bsdf> has no radio properties"},
      {scene_of("<bsdf type='radio-material' id='m'><float name='relative_permittivity' "
                "value='0.2'/></bsdf>",
                "<shape type='cube'><ref id='m' name='bsdf'/></shape>"),
       "material 'm': relative_permittivity is 0.2, must be at least 1"},
      {scene_of("<bsdf type='itu-radio-material' id='m'><string name='type' "
                "value='wood'/><float name='thickness' value='thick'/></bsdf>",
                "<shape type='cube'><ref id='m' name='bsdf'/></shape>"),
       "'thickness' must be a number, not 'thick'"},
      {scene_of(kConcreteBsdf,
                "<shape type='cube'><transform name='to_world'><lookat/></transform></shape>"),
       "<lookat> is not supported in a transform"},
      {scene_of(kConcreteBsdf,
                "<shape type='cube'><transform name='to_world'><matrix value='1 2'/>"
                "</transform></shape>"),
       "a <matrix> needs 16 numbers"},
      {scene_of(kConcreteBsdf,
                "<shape type='cube'><transform name='to_world'><rotate angle='3'/>"
                "</transform></shape>"),
       "a <rotate> needs an axis"},
      {scene_of(kConcreteBsdf,
                "<shape type='ply' id='mesh-a'><string name='filename' "
                "value='missing.ply'/><ref id='mat-itu_concrete'/></shape>"),
       "scene.xml:3:1: shape 'a': missing.ply does not exist"},
      {scene_of(kConcreteBsdf,
                "<shape type='ply' id='mesh-a'><string name='filename' "
                "value='a.stl'/><ref id='mat-itu_concrete'/></shape>"),
       "a.stl: a mesh is read from a .ply or .obj file"},
  };
  for (const auto& [xml, message] : cases) {
    EXPECT_NE(error_of(parse(xml)).find(message), std::string::npos)
        << "for " << xml << "\nwanted " << message << "\ngot " << error_of(parse(xml));
  }
}

TEST(LoadScene, FrequencyOutsideTheItuRangeIsRefused) {
  const auto scene = parse(scene_of(kConcreteBsdf, kShape), {200e9, {}});
  EXPECT_EQ(
      error_of(scene),
      "scene.xml:2:1: material 'concrete': ITU-R P.2040-4 states 'concrete' for 1 to 100 GHz, "
      "not for 200 GHz; state relative_permittivity and conductivity instead");
}

TEST(LoadScene, OverrideOfAnUnusedMaterialIsRefused) {
  SceneOptions changed = options();
  changed.materials["concrte"].thickness = 0.3;
  const auto scene = parse(scene_of(kConcreteBsdf, kShape), changed);
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().kind, ErrorKind::kConfiguration);
  EXPECT_EQ(error_of(scene),
            "scene.xml: values are stated for the material 'concrte', which no shape uses; did you "
            "mean 'concrete'?");
}

TEST(LoadScene, DegenerateTrianglesAreDroppedAndCounted) {
  const std::string mesh =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n2 0 0\n3 0 1 2\n3 0 1 3\n";
  const auto scene = parse(scene_of(kConcreteBsdf, kShape), options(), mesh);
  ASSERT_TRUE(scene) << error_of(scene);
  EXPECT_EQ(scene->triangle_count(), 1U);
  EXPECT_EQ(scene->dropped_triangles(), 1U);
}

TEST(LoadScene, ObjectOfDegenerateTrianglesOnlyIsRefused) {
  const std::string mesh =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n";
  EXPECT_EQ(error_of(parse(scene_of(kConcreteBsdf, kShape), options(), mesh)),
            "scene.xml: object 'floor' has no triangle that is at least a micrometre high");
}

TEST(LoadScene, MissingFileIsNamed) {
  const auto scene = load_scene("/nowhere/scene.xml", options());
  EXPECT_EQ(error_of(scene), "/nowhere/scene.xml does not exist");
}

TEST(LoadScene, ObjIsReadLikePly) {
  const std::string xml = scene_of(kConcreteBsdf,
                                   "<shape type='obj'><string name='filename' value='a.obj'/>"
                                   "<ref id='mat-itu_concrete'/></shape>");
  const auto scene = parse(xml, options(), "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\n");
  ASSERT_TRUE(scene) << error_of(scene);
  EXPECT_EQ(scene->triangle_count(), 2U);
  EXPECT_EQ(scene->surfaces().size(), 1U);
  EXPECT_NEAR(scene->surfaces()[0].area(), 2.0, 1e-12);
  EXPECT_NE(error_of(parse(xml, options(), "v 0 0 0\n")).find("a.obj"), std::string::npos);
}

TEST(Scene, RefusesInvalidInputs) {
  Scene::Input input;
  input.carrier_hz = test::kCarrier;
  input.materials = {test::kConcrete};
  EXPECT_NE(error_of(Scene::create(input)).find("no object"), std::string::npos);
  input.objects = {{"wall", test::rectangle_mesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), 0}};
  EXPECT_TRUE(Scene::create(input));
  auto broken = input;
  broken.objects[0].mesh.vertices[2].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(error_of(Scene::create(broken))
                .find("object 'wall': vertex 2 has a coordinate that is not a finite"),
            std::string::npos);
  broken = input;
  broken.objects[0].mesh.triangles[1][0] = 9;
  EXPECT_NE(error_of(Scene::create(broken)).find("triangle 1 refers to vertex 9 of 4"),
            std::string::npos);
  broken = input;
  broken.objects[0].material = 1;
  EXPECT_NE(error_of(Scene::create(broken)).find("has no material"), std::string::npos);
  broken = input;
  broken.carrier_hz = 0.0;
  EXPECT_NE(error_of(Scene::create(broken)).find("carrier frequency"), std::string::npos);
}

}  // namespace
}  // namespace rayloc::load_scene_test
