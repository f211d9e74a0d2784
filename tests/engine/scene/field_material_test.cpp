// Materials of scenes from the field, as Sionna RT reads them.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/scene/read/load_scene.h"
#include "tests/support/scenes.h"

namespace rayloc::field_material_test {
namespace {

Expected<Scene> parse(const std::string& content,
                      const SceneOptions& options = {test::kCarrier, {}}) {
  return parse_scene(
      "<scene version=\"2.1.0\">\n" + content + "</scene>", "scene.xml", options, nullptr);
}

std::string error_of(const Expected<Scene>& scene) {
  return scene ? "(no error)" : scene.error().message;
}

std::string wall_of(const std::string& id) {
  return R"(<shape type="rectangle" id="wall"><ref id=")" + id + "\" name=\"bsdf\"/></shape>\n";
}
std::string number(const std::string& name, const std::string& value) {
  return "<float name=\"" + name + "\" value=\"" + value + "\"/>";
}
std::string type_is(const std::string& value) {
  return R"(<string name="type" value=")" + value + "\"/>";
}
std::string bsdf(const std::string& type, const std::string& id, const std::string& inside) {
  return "<bsdf type=\"" + type + "\"" + (id.empty() ? "" : " id=\"" + id + "\"") + ">" + inside +
         "</bsdf>";
}

// The material of a scene with that one bsdf in line 2.
struct Read {
  RadioMaterial material;
  std::vector<SceneNote> notes;
};
Read read(const std::string& id, const std::string& one) {
  const auto scene = parse(one + "\n" + wall_of(id));
  EXPECT_TRUE(scene) << one << "\n" << error_of(scene);
  return scene ? Read{scene->material_of(0), scene->notes()} : Read{};
}

RadioMaterial of_table(const std::string& itu, const std::string& name, double thickness) {
  RadioMaterial material = itu_material(itu, test::kCarrier, thickness).value();
  material.name = name;
  return material;
}

TEST(Field, MaterialHasTheThicknessOfItsOuterBsdf) {
  const std::string id = "mat-itu_concrete";
  const RadioMaterial wanted = of_table("concrete", "concrete", 0.3);
  for (const std::string& one :
       {bsdf("twosided", id, number("thickness", "0.3") + bsdf("diffuse", "", "")),
        bsdf("twosided", id, bsdf("diffuse", "", number("thickness", " +0.3 "))),
        bsdf("diffuse", id, number("thickness", "0.3")),
        bsdf("twosided",
             id,
             number("thickness", "0.3") + bsdf("diffuse", "", number("thickness", "0.30")))}) {
    const Read found = read(id, one);
    EXPECT_EQ(found.material, wanted) << one;
    EXPECT_TRUE(found.notes.empty()) << one;
  }
  const auto twice =
      parse(bsdf("twosided",
                 id,
                 number("thickness", "0.3") + bsdf("diffuse", "", number("thickness", "0.2"))) +
            wall_of(id));
  EXPECT_NE(error_of(twice).find("is stated in another <bsdf> of this material with another value"),
            std::string::npos)
      << error_of(twice);
}

TEST(Field, MaterialTypeBesideAnItuIdCounts) {
  for (const std::string& one :
       {bsdf("diffuse", "mat-itu_concrete", type_is("glass")),
        bsdf("twosided", "mat-itu_concrete", type_is("glass") + bsdf("diffuse", "", "")),
        bsdf("itu-radio-material", "mat-itu_concrete", type_is("glass"))}) {
    const Read found = read("mat-itu_concrete", one);
    EXPECT_EQ(found.material, of_table("glass", "concrete", 0.1)) << one;
    ASSERT_EQ(found.notes.size(), 1U) << one;
    EXPECT_EQ(to_line(found.notes[0]),
              "scene.xml:2:1: warning: material 'concrete': its id names the ITU material "
              "'concrete', its type 'glass': 'glass' is read, as Sionna RT does");
  }
  // No contradiction.
  EXPECT_TRUE(read("mat-itu_wood", bsdf("itu-radio-material", "mat-itu_wood", type_is("wood")))
                  .notes.empty());
  EXPECT_TRUE(
      read("itu_human", bsdf("itu-radio-material", "itu_human", type_is("wood"))).notes.empty());
}

TEST(Field, MaterialOfItuTypeNeedsATypeOrAnId) {
  EXPECT_EQ(read("itu_brick", bsdf("itu-radio-material", "itu_brick", "")).material,
            of_table("brick", "brick", 0.1));
  const auto none =
      parse(bsdf("itu-radio-material", "wall-mat", R"(<string name="material" value="brick"/>)") +
            wall_of("wall-mat"));
  EXPECT_NE(error_of(none).find("scene.xml:2:47: <string name=\"material\"> of the material "
                                "'wall-mat' is not read"),
            std::string::npos)
      << error_of(none);
  EXPECT_NE(error_of(none).find("an itu-radio-material needs <string name=\"type\""),
            std::string::npos)
      << error_of(none);
}

TEST(Field, MaterialKeepsItsValuesUnderAnItuId) {
  const std::string values = number("relative_permittivity", "3") + number("conductivity", "0.2") +
                             number("thickness", "0.3");
  for (const std::string& one :
       {bsdf("radio-material", "mat-itu_concrete", values),
        bsdf("twosided", "mat-itu_concrete", bsdf("radio-material", "", values))}) {
    const Read found = read("mat-itu_concrete", one);
    EXPECT_EQ(found.material, (RadioMaterial{"concrete", 3.0, 0.2, 0.3})) << one;
    ASSERT_EQ(found.notes.size(), 1U) << one;
    EXPECT_NE(found.notes[0].message.find("states values of its own, and these are kept"),
              std::string::npos);
  }
  // Values that it does not state are the table's, not vacuum's.
  const Read half =
      read("itu_wood", bsdf("radio-material", "itu_wood", number("conductivity", "0.2")));
  EXPECT_EQ(half.material.relative_permittivity, 1.99);
  EXPECT_EQ(half.material.conductivity, 0.2);
  const Read none = read("itu_wood", bsdf("radio-material", "itu_wood", ""));
  EXPECT_EQ(none.material, of_table("wood", "wood", 0.1));
}

TEST(Field, MaterialWithoutValuesIsReportedAsVacuum) {
  const Read found = read("x", bsdf("radio-material", "x", ""));
  EXPECT_EQ(found.material, (RadioMaterial{"x", 1.0, 0.0, 0.1}));
  ASSERT_EQ(found.notes.size(), 1U);
  EXPECT_NE(found.notes[0].message.find("it is read as vacuum"), std::string::npos);
}

TEST(Field, ScatteringMaterialIsReadWithANoteOnItsUse) {
  const std::string rest = number("xpd_coefficient", "0.1") +
                           R"(<integer name="alpha_r" value="4"/>)" + number("alpha_i", "8") +
                           number("lambda_", "0.3") +
                           R"(<string name="scattering_pattern" value="backscattering"/>)" +
                           R"(<rgb name="color" value="1 0 0"/>)";
  const std::string permittivity = number("relative_permittivity", "3");
  const Read found = read(
      "x",
      bsdf("radio-material", "x", permittivity + number("scattering_coefficient", "0.3") + rest));
  EXPECT_EQ(found.material.scattering,
            (SurfaceScattering{0.3, 0.1, ScatteringPattern::kBackscattering, 4.0, 8.0, 0.3}));
  ASSERT_EQ(found.notes.size(), 1U);
  EXPECT_NE(found.notes[0].message.find("its scattering_coefficient counts for"),
            std::string::npos);
  const Read smooth = read(
      "x",
      bsdf("radio-material", "x", permittivity + number("scattering_coefficient", "0") + rest));
  EXPECT_TRUE(smooth.notes.empty());
  EXPECT_FALSE(smooth.material.scattering.is_rough());
}

TEST(Field, MaterialListsItsUnreadProperties) {
  struct Case {
    std::string bsdf;
    std::vector<std::string> expected;
  };
  for (const Case& each : std::vector<Case>{
           {bsdf("radio-material",
                 "m",
                 number("relative_permittivity", "4") + number("electrical_conductivity", "0.05")),
            {"scene.xml:2:83: <float name=\"electrical_conductivity\"> of the material 'm' is not "
             "read; did you mean 'conductivity'?"}},
           {bsdf("sionna_radio_material",
                 "m",
                 number("relative_permittivity", "3.1") + number("electrical_conductivity", "0.1")),
            {"scene.xml:2:1: the type 'sionna_radio_material' of the material 'm' is not known; "
             "write "
             "radio-material",
             "<float name=\"relative_permittivity\"> of the material 'm' is of the type "
             "radio-material "
             "only",
             "did you mean 'conductivity'?"}},
           {bsdf("diffuse", "m", number("conductivity", "3.1")),
            {"is of the type radio-material only"}},
           {bsdf("itu-radio-material", "m", type_is("wood") + number("relative_permittivity", "3")),
            {"is of the type radio-material only"}},
           {bsdf("radio-material", "m", type_is("wood") + number("conductivity", "3")),
            {"is of the type itu-radio-material only"}},
           {bsdf("radio-material", "m", number("sigma", "3")), {"<float name=\"sigma\">"}},
           {bsdf("radio-material", "m", number("thicknes", "3")), {"did you mean 'thickness'?"}},
           {bsdf("radio-material", "m", R"(<integer name="thickness" value="1"/>)"),
            {"scene.xml:2:36: <integer name=\"thickness\"> of the material 'm' is not read; write "
             "<float "
             "name=\"thickness\">"}},
           {bsdf("radio-material", "m", "<float name=\"thickness\">0.3</float>"),
            {"'thickness' must be a number, not ''", "text within <float> is not read"}},
           {bsdf("radio-material", "m", R"(<float name="thickness" val="0.3"/>)"),
            {"the attribute 'val' of <float> is not read; did you mean 'value'?"}},
           {bsdf("radio-material", "m", number("thickness", "1") + number("thickness", "2")),
            {"is stated twice"}},
           {bsdf("radio-material", "m", number("conductivity", "1"))
                .insert(6, R"(name="m" thickness="1" )"),
            {"the attribute 'thickness' of <bsdf> is not read"}},
           {bsdf("difuse", "mat-itu_wood", ""), {"did you mean 'diffuse'?"}},
           {bsdf("twosided", "mat-itu_wood", bsdf("diffuse", "", number("thicknes", "1"))),
            {"<float name=\"thicknes\"> of the material 'wood' is not read; did you mean "
             "'thickness'?"}},
           {bsdf("diffuse", "mat-itu_wood", R"(<string name="material" value="glass"/>)"),
            {"<string name=\"material\"> of the material 'wood' is not read"}},
       }) {
    const bool is_wood = each.bsdf.find("mat-itu_wood") != std::string::npos;
    const std::string message =
        error_of(parse(each.bsdf + "\n" + wall_of(is_wood ? "mat-itu_wood" : "m")));
    for (const std::string& expected : each.expected) {
      EXPECT_NE(message.find(expected), std::string::npos) << expected << "\n" << message;
    }
  }
}

TEST(Field, MaterialIsReadThroughReferences) {
  const std::string wood = bsdf("diffuse", "mat-itu_wood", "");
  const auto scene = parse(wood +
                           "<shape type=\"cube\" id=\"c\"><bsdf type=\"twosided\"><ref "
                           "id=\"mat-itu_wood\"/></bsdf></shape>" +
                           wall_of("mat-itu_wood"));
  ASSERT_TRUE(scene) << error_of(scene);
  ASSERT_EQ(scene->materials().size(), 1U);
  EXPECT_EQ(scene->materials()[0], of_table("wood", "wood", 0.1));

  // The id of the whole is its name; the id of a part names its material.
  EXPECT_EQ(
      read("elm__3", bsdf("twosided", "elm__3", bsdf("diffuse", "mat-itu_wood", ""))).material,
      of_table("wood", "elm__3", 0.1));
  // And only if the whole does not name it.
  EXPECT_EQ(read("itu_glass", bsdf("twosided", "itu_glass", bsdf("diffuse", "mat-itu_wood", "")))
                .material,
            of_table("glass", "glass", 0.1));
}

TEST(Field, MaterialOfTwoMaterialsIsRefused) {
  const std::string both =
      bsdf("diffuse", "mat-itu_wood", "") + bsdf("diffuse", "mat-itu_glass", "");
  EXPECT_NE(error_of(parse(both +
                           bsdf("blendbsdf",
                                "m",
                                "<ref id=\"mat-itu_wood\"/><ref "
                                "id=\"mat-itu_glass\"/>") +
                           wall_of("m")))
                .find("it is made of 'wood' and of 'glass'"),
            std::string::npos);
  EXPECT_NE(
      error_of(parse(bsdf("twosided", "m", "<ref id=\"mat-itu_woood\"/>") + both + wall_of("m")))
          .find("there is no <bsdf> with the id 'mat-itu_woood'; did you mean 'mat-itu_wood'?"),
      std::string::npos);
}

// References in a circle, and each to all others.
TEST(Field, MaterialOfReferencesInACircleEnds) {
  std::string all;
  for (int i = 0; i < 40; ++i) {
    std::string references;
    for (int j = 0; j < 40; ++j) {
      references += "<ref id=\"b" + std::to_string(j) + "\"/>";
    }
    all += bsdf("twosided", "b" + std::to_string(i), references);
  }
  EXPECT_NE(error_of(parse(all + wall_of("b0"))).find("has no radio properties"),
            std::string::npos);

  std::string deep = bsdf("diffuse", "", "");
  for (int i = 0; i < 100; ++i) {
    deep = bsdf("twosided", i == 99 ? "mat-itu_wood" : "", deep);
  }
  EXPECT_NE(error_of(parse(deep + wall_of("mat-itu_wood"))).find("is made of too many <bsdf>s"),
            std::string::npos);
}

TEST(Field, MaterialsOfOneNameAreMergedOrRenamed) {
  const std::string two =
      bsdf("diffuse", "mat-itu_wood", "") + bsdf("diffuse", "itu_wood", number("thickness", "0.1"));
  const std::string shapes =
      wall_of("mat-itu_wood") + R"(<shape type="cube" id="box"><ref id="itu_wood"/></shape>)";
  const auto same = parse(two + shapes);
  ASSERT_TRUE(same) << error_of(same);
  EXPECT_EQ(same->materials().size(), 1U);

  const auto other =
      parse(bsdf("diffuse", "mat-itu_wood", "") +
            bsdf("radio-material", "itu_wood", number("relative_permittivity", "4")) + shapes);
  ASSERT_TRUE(other) << error_of(other);
  ASSERT_EQ(other->materials().size(), 2U);
  EXPECT_EQ(other->materials()[1].name, "wood_2");
  EXPECT_EQ(other->notes().back().message,
            "a second material is called 'wood' and has other values: it goes by 'wood_2'");
}

TEST(Field, MaterialsOfAnErrorAreListedOnce) {
  SceneOptions options{test::kCarrier, {}};
  options.materials["carpet"].thickness = 0.3;
  const auto scene =
      parse(bsdf("diffuse", "mat-itu_wood", "") +
                bsdf("diffuse", "itu_wood", number("thickness", "0.2")) + wall_of("mat-itu_wood") +
                R"(<shape type="cube" id="box"><ref id="itu_wood"/></shape>)" +
                R"(<shape type="cube" id="b2"><bsdf type="diffuse" id="itu_wood"/></shape>)",
            options);
  EXPECT_EQ(
      error_of(scene),
      "scene.xml: values are stated for the material 'carpet', which no shape uses; there are: "
      "wood, wood_2");
}

TEST(Field, MaterialIdsThatSionnaRefusesAreClearErrors) {
  for (const char* id : {"mat-itu-concrete", "mat-concrete", "mat-itu_concrete.001"}) {
    const std::string message = error_of(parse(bsdf("diffuse", id, "") + "\n" + wall_of(id)));
    EXPECT_NE(message.find("scene.xml:2:1: material '"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace rayloc::field_material_test
