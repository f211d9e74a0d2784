// Scenes from the field: what was not read is an error that names it, and what only the eye needs
// is left out knowingly.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/scene/read/load_scene.h"
#include "engine/scene/read/visual_names.h"
#include "tests/support/scenes.h"
#include "tests/support/test_paths.h"

namespace rayloc::field_xml_test {
namespace {

constexpr const char* kFloor =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n4 0 0\n+4.0 +3.0 0\n0 3 0\n4 0 1 2 3\n";

constexpr const char* kConcrete =
    "<bsdf type=\"twosided\" id=\"mat-itu_concrete\"><bsdf type=\"diffuse\"/></bsdf>\n";
constexpr const char* kRef = R"(<ref id="mat-itu_concrete" name="bsdf"/>)";

Expected<Scene> parse(const std::string& xml, std::vector<std::string>* asked_for = nullptr) {
  return parse_scene(xml,
                     "scene.xml",
                     {test::kCarrier, {}},
                     [&](const std::string& name) -> Expected<std::string> {
                       if (asked_for != nullptr) {
                         asked_for->push_back(name);
                       }
                       return std::string(kFloor);
                     });
}

// The scene of a concrete bsdf in line 2 and `rest` from line 3 on.
Expected<Scene> parse_rest(const std::string& rest) {
  return parse("<scene version=\"3.0.0\">\n" + std::string(kConcrete) + rest + "</scene>\n");
}

std::string error_of(const Expected<Scene>& scene) {
  return scene ? "(no error)" : scene.error().message;
}

std::string shape(const std::string& inside) {
  return R"(<shape type="rectangle" id="wall">)" + inside + kRef + "</shape>\n";
}

struct Mistake {
  std::string xml;       // in place of a scene's content
  std::string place;     // of the message
  std::string expected;  // in it
};

void expect_refused(const std::vector<Mistake>& mistakes) {
  for (const Mistake& mistake : mistakes) {
    const std::string message = error_of(parse_rest(mistake.xml));
    EXPECT_NE(message.find("scene.xml:" + mistake.place + ": "), std::string::npos)
        << mistake.xml << "\n"
        << message;
    EXPECT_NE(message.find(mistake.expected), std::string::npos) << mistake.xml << "\n" << message;
  }
}

TEST(Field, SceneXmlReportsUnreadPartsOfAShape) {
  expect_refused({
      {shape(R"(<transform name="toWorld"><scale x="2"/></transform>)"),
       "3:35",
       "<transform name=\"toWorld\"> of the shape 'wall' is not read; did you mean 'to_world'?"},
      {shape("<transform><scale x=\"2\"/></transform>"),
       "3:35",
       "it has no name; there are: to_world"},
      {shape(R"(<transform name="to_world"/><transform name="to_world"/>)"),
       "3:63",
       "stated twice"},
      {shape("<scale x=\"2\"/>"),
       "3:35",
       "<scale> of the shape 'wall' is not read; it belongs into"},
      {shape(R"(<float name="thickness" value="0.3"/>)"), "3:35", "<float name=\"thickness\">"},
      {shape(R"(<string name="material" value="glass"/>)"), "3:35", "<string name=\"material\">"},
      {shape("concrete"), "3:35", "text within <shape> is not read"},
      {R"(<shape type="rectangle" id="wall" material="glass">)" + std::string(kRef) + "</shape>",
       "3:1",
       "the attribute 'material' of <shape> is not read"},
      {R"(<shape type="ply" id="wall"><rgb name="filename" value="a.ply"/>)" + std::string(kRef) +
           "</shape>",
       "3:29",
       "write <string name=\"filename\">"},
      {R"(<shape type="ply" id="w"><string name="fileName" value="a.ply"/>)" + std::string(kRef) +
           "</shape>",
       "3:26",
       "did you mean 'filename'?"},
      {R"(<shape type="rectangle"><ref id="mat-itu_concrete" as="bsdf"/></shape>)",
       "3:25",
       "the attribute 'as' of <ref> is not read"},
  });
}

TEST(Field, SceneXmlReportsUnreadPartsOfATransform) {
  const auto step = [](const std::string& text) {
    return shape("<transform name=\"to_world\">\n" + text + "</transform>");
  };
  expect_refused({
      {step("<translate X=\"1\"/>"),
       "4:1",
       "the attribute 'X' of <translate> is not read; did you"},
      {step("<translate/>"), "4:1", "a <translate> needs x, y, z or value"},
      {step(R"(<translate x="1" value="2"/>)"), "4:1", "either 'value' or x, y, z"},
      {step("<translate x=\"1,5\"/>"), "4:1", "'x' must be a number, not '1,5'"},
      {step(R"(<rotate axis="z" angle="9"/>)"), "4:1", "the attribute 'axis' of <rotate>"},
      {step(R"(<rotate z="1" angle="9" unit="rad"/>)"), "4:1", "the attribute 'unit' of <rotate>"},
      {step("<matrix values=\"1\"/>"), "4:1", "the attribute 'values' of <matrix>"},
      // Written column by column: the translation would be lost.
      {step("<matrix value=\"1 0 0 0 0 1 0 0 0 0 1 0 5 0 0 1\"/>"),
       "4:1",
       "the last row of a <matrix> must be 0 0 0 1"},
      {step("<matrix value=\"1 0 0 0 0 -1 0 1 0\"/>"), "4:1", "a <matrix> needs 16 numbers"},
      {step(R"(<lookat origin="0,0,0" target="0,1,0" up="0,0,1"/>)"),
       "4:1",
       "<lookat> is not supported in a transform"},
      {shape(R"(<transform name="to_world" type="x"/>)"), "3:35", "the attribute 'type'"},
  });
}

TEST(Field, SceneXmlReportsUnreadPartsOfTheScene) {
  const std::string good = shape("");
  expect_refused({
      {good + "<Shape type=\"cube\"/>", "4:1", "<Shape> of the scene is not read; did you mean"},
      {good + "<group>" + shape("") + "</group>", "4:1", "<group> of the scene is not read"},
      {good + R"(<float name="unit" value="0.01"/>)", "4:1", "<float name=\"unit\">"},
      {good + "<path value=\"meshes\"/>", "4:1", "<path> is not supported"},
      {good + R"(<alias id="mat-itu_concrete" as="x"/>)", "4:1", "<alias> is not supported"},
      {good + "<bsdf type=\"diffuse\"/>", "4:1", "this <bsdf> has no id"},
      {good + R"(<bsdf type="diffuse" id="mat-itu_concrete"/>)",
       "4:1",
       "two <bsdf>s have the id 'mat-itu_concrete'; the first is at scene.xml:2:1"},
      {good + "</scene><scene version=\"2.1.0\">", "4:9", "a file has one <scene>"},
  });
  EXPECT_NE(error_of(parse("<scene unit=\"cm\">" + std::string(kConcrete) + good + "</scene>"))
                .find("the attribute 'unit' of <scene> is not read"),
            std::string::npos);
}

TEST(Field, SceneXmlReportsAllMistakesInTheOrderOfTheFile) {
  const std::string message =
      error_of(parse_rest(shape(R"(<float name="thickness" value="0.3"/>)") +
                          "<shape type=\"cube\" id=\"box\"><transform name=\"toWorld\"/><ref "
                          "id=\"glass\"/></shape>\n"));
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 2) << message;
  EXPECT_LT(message.find("scene.xml:3:35"), message.find("scene.xml:4:29")) << message;
  EXPECT_NE(message.find("there is no <bsdf> with the id 'glass'"), std::string::npos) << message;
}

TEST(Field, SceneXmlLimitsTheNumberOfReportedMistakes) {
  std::string rest;
  for (int i = 0; i < 5'000; ++i) {
    rest += R"(<shape type="cube" id="w)" + std::to_string(i) + "\"><flaot name=\"x\"/></shape>\n";
  }
  const std::string message = error_of(parse_rest(rest));
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 20) << message;
}

TEST(Field, SceneXmlRefusesTwoShapesOfOneId) {
  expect_refused({
      {shape("") + shape(""), "4:1", "two shapes are called 'wall'; the first is at scene.xml:3:1"},
      {R"(<shape type="cube" id="mesh-box">)" + std::string(kRef) +
           R"(</shape><shape type="cube" id="box">)" + kRef + "</shape>",
       "3:82",
       "two shapes are called 'box'"},
  });
  const auto unnamed = parse_rest(R"(<shape type="cube" id="shape1">)" + std::string(kRef) +
                                  "</shape><shape type=\"cube\">" + kRef + "</shape>");
  ASSERT_TRUE(unnamed) << error_of(unnamed);
  EXPECT_EQ(unnamed->objects()[1].name, "shape2");
}

TEST(Field, SceneXmlRefusesTwoMaterialsOfOneShape) {
  expect_refused({{shape(R"(<bsdf type="diffuse" id="mat-itu_glass"/>)"),
                   "3:1",
                   "shape 'wall' has 2 materials ("}});
}

TEST(Field, SceneXmlIgnoresVisualElements) {
  const auto scene = parse(
      "<scene version=\"3.0.0\" xmlns=\"urn:x\">\n"
      "<integrator type=\"path\"><integer name=\"max_depth\" value=\"12\"/></integrator>"
      "<sensor type=\"perspective\"><transform name=\"toWorld\"><lookat "
      "origin=\"1,1,1\"/></transform>"
      "<film type=\"hdrfilm\"/><sampler type=\"independent\"/></sensor>"
      "<emitter type=\"constant\" id=\"World\"><rgb name=\"radiance\" value=\"1\"/></emitter>"
      "<texture type=\"bitmap\" id=\"tex\"><string name=\"filename\" value=\"a.png\"/></texture>"
      "<bsdf type=\"mask\" id=\"mat-itu_wood\" name=\"mat-itu_wood\">"
      "<float name=\"opacity\" value=\"0.5\"/><bsdf type=\"twosided\" name=\"bsdf\">"
      "<bsdf type=\"principled\"><rgb name=\"base_color\" value=\"0.8\"/>"
      "<texture type=\"bitmap\" name=\"roughness\"/><ref id=\"tex\" name=\"metallic\"/>"
      "<float name=\"spec_tint\" value=\"1\"/><float name=\"main_specular_sampling_rate\" "
      "value=\"1\"/></bsdf></bsdf></bsdf>"
      "<bsdf type=\"roughconductor\" id=\"mat-itu_metal\"><string name=\"material\" value=\"Al\"/>"
      "<string name=\"distribution\" value=\"ggx\"/><float name=\"intIOR\" value=\"1.5\"/></bsdf>"
      "<shape type=\"ply\" id=\"mesh-floor\" name=\"mesh-floor\"><string name=\"filename\" "
      "value=\"floor.ply\"/><boolean name=\"face_normals\" value=\"true\"/><boolean "
      "name=\"flip_normals\" value=\"true\"/><ref id=\"mat-itu_wood\" name=\"bsdf\"/></shape>"
      "<shape type=\"cube\" id=\"box\"><ref name=\"bsdf\" id=\"mat-itu_metal\"/></shape></scene>");
  ASSERT_TRUE(scene) << error_of(scene);
  EXPECT_TRUE(scene->notes().empty()) << to_line(scene->notes()[0]);
  EXPECT_EQ(scene->objects().size(), 2U);
}

TEST(Field, SceneXmlLeavesOutLampsAndNullShapesWithANote) {
  const auto scene = parse_rest(
      shape("") +
      "<shape type=\"rectangle\" id=\"emit-Lamp\"><emitter type=\"area\"/><bsdf "
      "type=\"null\"/></shape>\n"
      "<shape type=\"disk\" id=\"spot\"><emitter type=\"area\"/></shape>\n"
      "<shape type=\"sphere\" id=\"bulb\"><point name=\"center\" x=\"1\"/><float name=\"radius\" "
      "value=\"0.1\"/><emitter type=\"area\"/><bsdf type=\"diffuse\"/></shape>\n"
      "<shape type=\"cylinder\" id=\"fog\"><bsdf type=\"mask\"><bsdf "
      "type=\"null\"/></bsdf></shape>\n"
      "<shape type=\"ply\" id=\"mesh-portal\"><string name=\"filename\" value=\"gone.ply\"/><bsdf "
      "type=\"null\"/></shape>\n");
  ASSERT_TRUE(scene) << error_of(scene);
  ASSERT_EQ(scene->objects().size(), 1U);
  EXPECT_EQ(scene->objects()[0].name, "wall");
  ASSERT_EQ(scene->notes().size(), 1U);
  EXPECT_EQ(scene->notes()[0].kind, "left_out");
  EXPECT_EQ(to_line(scene->notes()[0]),
            "scene.xml:4:1: warning: shapes that waves do not meet are left out: 'emit-Lamp' (a "
            "lamp), 'spot' (a lamp), 'bulb' (a lamp), 'fog' (a null material), 'portal' (a null "
            "material)");
}

TEST(Field, SceneXmlKeepsALampOfARadioMaterial) {
  const auto scene = parse_rest(shape("<emitter type=\"area\"/>"));
  ASSERT_TRUE(scene) << error_of(scene);
  EXPECT_EQ(scene->objects().size(), 1U);
  expect_refused({
      {R"(<shape type="sphere" id="ball"><emitter type="area"/>)" + std::string(kRef) + "</shape>",
       "3:1",
       "shape 'ball' has type 'sphere'"},
      {"<shape type=\"cube\" id=\"a\"><emitter type=\"area\"/><ref "
       "id=\"mat-itu_concret\"/></shape>",
       "3:49",
       "there is no <bsdf> with the id 'mat-itu_concret'"},
      {R"(<shape type="cube" id="a"><emitter type="area"/></shape>)",
       "1:1",
       "every <shape> of the scene is a lamp"},
  });
}

TEST(Field, SceneXmlTakesNoReferenceWithoutAnIdForALamp) {
  expect_refused({{"<emitter type=\"constant\"/>\n<shape type=\"cube\" id=\"a\"><ref/></shape>\n",
                   "4:27",
                   "there is no <bsdf> with the id ''"}});
}

TEST(Field, SceneXmlReadsDefaults) {
  const auto scene = parse(
      "<scene version=\"3.0.0\"><default name=\"h\" value=\"2.5\"/><default name=\"hall\" "
      "value=\"7\"/><default name=\"h\" value=\"9\"/><default name=\"m\" "
      "value=\"itu_wood\"/><default "
      "name=\"id\" value=\"mat-$m\"/>"
      "<bsdf type=\"diffuse\" id=\"$id\"/><shape type=\"rectangle\" id=\"c\"><transform "
      "name=\"to_world\"><translate value=\"$hall 0 $h\"/></transform><ref id=\"mat-$m\"/></shape>"
      "</scene>");
  ASSERT_TRUE(scene) << error_of(scene);
  EXPECT_EQ(scene->bounds_min(), (Vec3d{6.0, -1.0, 2.5}));
  EXPECT_EQ(scene->materials()[0].name, "wood");
}

TEST(Field, SceneXmlRefusesDefaultsThatAreNotThere) {
  expect_refused({
      {R"(<default name="h" value="2"/>)" + shape("<transform name=\"to_world\"><translate "
                                                  "z=\"$height\"/></transform>"),
       "3:91",
       "'z' must be a number, not '2eight'"},
      {R"(<default name="height" value="2"/>)" + shape("<transform name=\"to_world\"><translate "
                                                       "z=\"$heigth\"/></transform>"),
       "3:96",
       "there is no <default> for '$heigth' before this; did you mean 'height'?"},
      {"<default value=\"2\"/>" + shape(""), "3:1", "a <default> needs a name and a value"},
      {shape(R"(<transform name="to_world"><translate z="$h"/></transform>)"),
       "3:62",
       "'z' must be a number, not '$h'"},
  });
}

// Ten lines that each name the one before ten times.
TEST(Field, SceneXmlDoesNotGrowWithItsDefaults) {
  std::string rest = "<default name=\"a0\" value=\"0123456789\"/>\n";
  for (int i = 1; i < 10; ++i) {
    const std::string before = "$a" + std::to_string(i - 1);
    rest += "<default name=\"a" + std::to_string(i) + "\" value=\"";
    for (int j = 0; j < 10; ++j) {
      rest += before;
    }
    rest += "\"/>\n";
  }
  const std::string message = error_of(parse_rest(rest + shape("")));
  EXPECT_NE(message.find("scene.xml:6:1: a value with its <default>s is longer"), std::string::npos)
      << message;
}

TEST(Field, SceneXmlReadsPathsOfWindows) {
  std::vector<std::string> asked_for;
  const auto scene = parse("<scene>" + std::string(kConcrete) +
                               "<shape type=\"ply\" id=\"f\"><string name=\"filename\" "
                               "value=\"meshes\\sub\\Floor.PLY\"/>" +
                               kRef + "</shape></scene>",
                           &asked_for);
  ASSERT_TRUE(scene) << error_of(scene);
  EXPECT_EQ(asked_for, std::vector<std::string>{"meshes/sub/Floor.PLY"});
  EXPECT_EQ(scene->bounds_max(), (Vec3d{4.0, 3.0, 0.0}));
}

TEST(Field, PlyRefusesWordsThatBeginLikeNumbers) {
  for (const char* word : {"4,5", "4.0.5", "4m", "++4", "+-4"}) {
    std::string mesh = kFloor;
    mesh.replace(mesh.find("+4.0"), 4, word);
    const auto scene =
        parse_scene("<scene>" + std::string(kConcrete) +
                        "<shape type=\"ply\" id=\"f\"><string name=\"filename\" "
                        "value=\"f.ply\"/>" +
                        kRef + "</shape></scene>",
                    "scene.xml",
                    {test::kCarrier, {}},
                    [&](const std::string&) -> Expected<std::string> { return mesh; });
    EXPECT_NE(error_of(scene).find("f.ply:12: a number is missing for 'x'"), std::string::npos)
        << word << "\n"
        << error_of(scene);
  }
}

TEST(Field, SceneXmlReportsUtf16) {
  std::string wide;
  for (const char c : "<scene version=\"3.0.0\"></scene>") {
    wide += {c, '\0'};
  }
  for (const std::string& text : {wide, "\xFF\xFE" + wide, "\xFE\xFF" + wide.substr(1)}) {
    EXPECT_NE(error_of(parse(text)).find("save it as UTF-8"), std::string::npos)
        << error_of(parse(text));
  }
}

TEST(Field, SceneXmlCountsColumnsAfterAByteOrderMark) {
  EXPECT_NE(
      error_of(parse("\xEF\xBB\xBF<scene unit=\"cm\"/>")).find("scene.xml:1:1: the attribute"),
      std::string::npos);
}

TEST(Field, SceneXmlWarnsOfAxesThatAreNoUnitVectors) {
  const auto rotated = [](const std::string& axis) {
    return shape("<transform name=\"to_world\"><rotate " + axis + " angle=\"40\"/></transform>");
  };
  const auto scene = parse_rest(rotated(R"(x="1" y="1")"));
  ASSERT_TRUE(scene) << error_of(scene);
  ASSERT_EQ(scene->notes().size(), 1U);
  EXPECT_EQ(scene->notes()[0].kind, "rotation_axis");
  EXPECT_NE(to_line(scene->notes()[0])
                .find("scene.xml:3:62: warning: the axis of this <rotate> has the length 1.414214 "
                      "instead of 1: the shape is rotated about it; Mitsuba"),
            std::string::npos)
      << to_line(scene->notes()[0]);
  // Rotated, not deformed.
  const std::vector<Vec3d>& corners = scene->objects()[0].mesh.vertices;
  EXPECT_NEAR(norm(corners[1] - corners[0]), 2.0, 1e-12);

  const auto several = parse_rest(rotated("z=\"2\"") +
                                  "<shape type=\"cube\" id=\"b\"><transform "
                                  "name=\"to_world\"><rotate z=\"3\" angle=\"1\"/></transform>" +
                                  kRef + "</shape>");
  ASSERT_TRUE(several) << error_of(several);
  ASSERT_EQ(several->notes().size(), 1U);
  EXPECT_NE(several->notes()[0].message.find("and so have 1 more"), std::string::npos);

  const auto unit = parse_rest(rotated(R"(x="0.5774" y="0.5774" z="-0.5774")"));
  ASSERT_TRUE(unit) << error_of(unit);
  EXPECT_TRUE(unit->notes().empty());
}

// Deliberate omissions are documented, name by name.
TEST(Field, ScenePageListsIgnoredElements) {
  std::ostringstream text;
  text << std::ifstream(test::source_path("/engine/scene/FILES.md")).rdbuf();
  const std::string readme = text.str();
  for (const auto names : {visual_tags(),
                           visual_bsdf_tags(),
                           visual_bsdf_types(),
                           visual_shape_properties(),
                           visual_bsdf_properties(),
                           visual_bsdf_prefixes()}) {
    for (const std::string_view name : names) {
      EXPECT_NE(readme.find("`" + std::string(name) + "`"), std::string::npos) << name;
    }
  }
}

}  // namespace
}  // namespace rayloc::field_xml_test
