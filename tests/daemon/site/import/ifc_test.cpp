// An office as IFC 2x3, and files on which the library assimp would end the process.
#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/site/import/ifc/ifc_check.h"
#include "daemon/site/import/ifc/ifc_materials.h"
#include "daemon/site/import/ifc/ifc_types.h"
#include "daemon/site/import/ifc/ifc_units.h"
#include "daemon/site/import/import_scene.h"
#include "tests/daemon/site/import/import_files.h"
#include "tests/support/test_paths.h"

namespace rayloc::ifc_test {
namespace {

std::string office() {
  std::ifstream in(test::data_path("/scenes/office.ifc"), std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(in)), {});
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// The office with another line for an entity; the same text in a comment precedes it.
std::string with_entity(const std::string& begin, const std::string& line) {
  const std::string text = office();
  const std::size_t at = text.rfind("\n" + begin + "=");
  EXPECT_NE(at, std::string::npos) << begin;
  std::string changed = text;
  return changed.replace(at + 1, text.find('\n', at + 1) - at - 1, line);
}

std::string file_of(const std::string& entities) {
  return "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC2X3'));\nENDSEC;\nDATA;\n" + entities +
         "ENDSEC;\nEND-ISO-10303-21;\n";
}

StepText step_of(const std::string& entities) {
  auto step = StepText::parse(file_of(entities), "x.ifc");
  EXPECT_TRUE(step) << step.error().message;
  return step ? *std::move(step) : StepText();
}

class Ifc : public test::ImportFiles {};

TEST_F(Ifc, OfficeHasItsSizeNamesAndMaterials) {
  const auto made = import(file("office.ifc", office()));
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_NEAR(made->bounds.size().x, 5.24, 1e-4);
  EXPECT_NEAR(made->bounds.size().y, 4.24, 1e-4);
  EXPECT_NEAR(made->bounds.size().z, 3.0, 1e-4);
  std::map<std::string, std::string> materials;
  for (const StatedObject& object : made->scene.objects) {
    materials[object.name] = object.material;
  }
  // The walls 3 and 4 have two layers, the window has the material of its type.
  EXPECT_EQ(materials,
            (std::map<std::string, std::string>{{"IfcDoor_T__r__1__links_", "wood"},
                                                {"IfcFurnishingElement_Tisch", "wood"},
                                                {"IfcSlab_Floor_Concrete_200", "concrete"},
                                                {"IfcSlab_Roof_slab", "concrete"},
                                                {"IfcWallStandardCase_Wand_1", "brick"},
                                                {"IfcWallStandardCase_Wand_2", "brick"},
                                                {"IfcWallStandardCase_Wand_3", "plasterboard"},
                                                {"IfcWallStandardCase_Wand_4", "plasterboard"},
                                                {"IfcWindow_Fl__gel", "glass"}}));
  EXPECT_EQ(remarks(*made).find("IFCDefault"), std::string::npos) << remarks(*made);
}

TEST_F(Ifc, DoorsAndWindowsAreOpeningsOfTheirWalls) {
  const auto made = import(file("office.ifc", office()));
  ASSERT_TRUE(made) << made.error().message;
  std::map<std::string, std::size_t> triangles;
  for (const StatedObject& object : made->scene.objects) {
    triangles[object.name] = object.mesh.triangles.size();
  }
  EXPECT_EQ(triangles["IfcWallStandardCase_Wand_3"], 12U);
  EXPECT_GT(triangles["IfcWallStandardCase_Wand_1"], 12U);
  EXPECT_GT(triangles["IfcWallStandardCase_Wand_2"], 12U);
}

// Walls of one mesh that several elements refer to are named after the element.
TEST_F(Ifc, MappedShapesHaveTheNameOfTheirElement) {
  const std::string shape =
      "#88=IFCPRODUCTDEFINITIONSHAPE($,$,(#204));\n"
      "#204=IFCSHAPEREPRESENTATION(#10,'Body','MappedRepresentation',(#203));\n"
      "#200=IFCSHAPEREPRESENTATION(#10,'Body','SweptSolid',(#86));\n"
      "#201=IFCREPRESENTATIONMAP(#9,#200);\n"
      "#202=IFCCARTESIANTRANSFORMATIONOPERATOR3D($,$,#6,$,$);\n"
      "#203=IFCMAPPEDITEM(#201,#202);";
  const auto made = import(file("office.ifc", with_entity("#88", shape)));
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(std::any_of(
      made->scene.objects.begin(), made->scene.objects.end(), [](const StatedObject& object) {
        return object.name == "IfcFurnishingElement_Tisch" && object.material == "wood";
      }));
}

// Each of these ended assimp 5.2.5 with a signal, or ran without an end.
TEST_F(Ifc, RefusesFilesThatEndTheReader) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {with_entity("#27", "#27=IFCSHAPEREPRESENTATION(#10,'Body','Tessellation',(#154));"),
       "x.ifc:37: #27 IFCSHAPEREPRESENTATION refers to #154, whose type IFCTRIANGULATEDFACESET"},
      {with_entity("#27", "#27=IFCSHAPEREPRESENTATION(#10,'Body','SweptSolid',(#99999));"),
       "x.ifc:37: #27 IFCSHAPEREPRESENTATION refers to #99999, which does not exist"},
      {with_entity("#14", "#14=IFCLOCALPLACEMENT(#14,#9);"), "x.ifc:24: #14 IFCLOCALPLACEMENT"},
      {with_entity("#20", "#20=IFCRELAGGREGATES('09A2v1ZVYENib8LKWLYbwf',#5,$,$,#16,(#15));"),
       "is a part of its own part"},
      {with_entity("#28", "#28=IFCPRODUCTDEFINITIONSHAPE($,$,(#30));"), "for a representation"},
      {with_entity("#26", "#26=IFCEXTRUDEDAREASOLID(#23,*,#7,200.0);"), "'*'"},
      {with_entity("#24", "#24=IFCCARTESIANPOINT((2500.0,2000.0,1.E30));"), "1.E30"},
  };
  for (const auto& [content, message] : cases) {
    const auto imported = import(file("x.ifc", content));
    ASSERT_FALSE(imported) << message;
    EXPECT_EQ(imported.error().kind, ErrorKind::kBadInput);
    EXPECT_NE(imported.error().message.find(message), std::string::npos)
        << imported.error().message;
  }
}

TEST_F(Ifc, RefusesOtherSchemas) {
  for (const char* schema : {"IFC4", "IFC4X3_ADD2", "IFC2X2_FINAL"}) {
    const std::string error = refusal("x.ifc", with(office(), "IFC2X3", schema));
    EXPECT_NE(error.find(schema), std::string::npos) << error;
    EXPECT_NE(error.find("IFC 2x3"), std::string::npos) << error;
  }
}

TEST_F(Ifc, RefusesFilesThatAreCutOrDamaged) {
  const std::string text = office();
  const std::vector<std::pair<std::string, std::string>> cases = {
      {text.substr(0, text.find("#150=")), "ends before its data"},
      {text.substr(0, text.find("#150=") + 10), "ends within a statement"},
      {with(text, "'Gipskarton'", "'Gipskarton"), "a string has no end"},
      {with(text, "*/", ""), "a comment has no end"},
      {with(text, "#2=", "#1="), "#1 is defined twice"},
      {with(text, "#2=", "#x="), "is no entity"},
      {with(text, "#2=", "#2=\x01"), "has a byte"},
      {with(text, "$,$,$,0)", std::string(40, '(') + std::string(40, ')') + ",$,$,0)"), "nested"},
  };
  for (const auto& [content, message] : cases) {
    const std::string error = refusal("x.ifc", content);
    EXPECT_NE(error.find(message), std::string::npos) << message << ": " << error;
  }
}

TEST_F(Ifc, UnitsOfAFootAreConverted) {
  const std::string text =
      with_entity("#12",
                  "#12=IFCUNITASSIGNMENT((#203));\n#200=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);\n"
                  "#201=IFCDIMENSIONALEXPONENTS(1,0,0,0,0,0,0);\n"
                  "#202=IFCMEASUREWITHUNIT(IFCLENGTHMEASURE(0.0003048),#200);\n"
                  "#203=IFCCONVERSIONBASEDUNIT(#201,.LENGTHUNIT.,'a thousandth of a foot',#202);");
  const auto made = import(file("office.ifc", text));
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_NEAR(made->bounds.size().x, 5240.0 * 0.0003048, 1e-4);
}

TEST(IfcCheck, DeepReferencesAreRefusedWithoutRecursion) {
  std::string entities = "#1=IFCLOCALPLACEMENT($,$);\n";
  for (int id = 2; id <= 100'000; ++id) {
    entities += fmt::format("#{}=IFCLOCALPLACEMENT(#{},$);\n", id, id - 1);
  }
  const auto checked = check_ifc(step_of(entities), "x.ifc");
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().message.find("nested"), std::string::npos);
}

// Thirty assemblies, each of which has the next one twice, are a billion elements.
TEST(IfcCheck, RepeatedPartsAreRefused) {
  std::string entities = "#1=IFCBUILDING();\n";
  for (int id = 2; id <= 30; ++id) {
    entities +=
        fmt::format("#{}=IFCELEMENTASSEMBLY();\n#{}=IFCRELAGGREGATES('',$,$,$,#{},(#{},#{}));\n",
                    id,
                    100 + id,
                    id - 1,
                    id,
                    id);
  }
  const auto checked = check_ifc(step_of(entities), "x.ifc");
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().message.find("many times"), std::string::npos);
}

TEST(IfcCheck, TypesAreThoseOfTheStandard) {
  for (const char* type : {"IFCWALL", "IFCWALLSTANDARDCASE", "IFC2DCOMPOSITECURVE", "IFCZONE"}) {
    EXPECT_TRUE(is_ifc2x3_type(type)) << type;
  }
  for (const char* type : {"", "IFC", "IFCWAL", "WALL", "IFCTRIANGULATEDFACESET", "IFCALARM"}) {
    EXPECT_FALSE(is_ifc2x3_type(type)) << type;
  }
}

TEST(IfcCheck, TheTextForTheReaderHasNoComments) {
  const StepText step =
      step_of("#1=/* #2 */IfcWall ( 'it''s #3; (\\S\\|)' ,\n $ );\n#2=IFCFOO(#1);\n");
  EXPECT_EQ(plain_ifc(step), file_of("#1=IFCWALL('it_s _3_ _\u00fc_',$);\n"));
}

TEST(StepString, IsDecoded) {
  const std::map<std::string, std::string> cases = {
      {"'plain'", "plain"},
      {"''", ""},
      {"'it''s'", "it's"},
      {"'T\\X2\\00FC\\X0\\r'", "T\u00fcr"},
      {"'\\X2\\D83DDE00\\X0\\'", "\U0001F600"},
      {"'\\X4\\0001F600\\X0\\'", "\U0001F600"},
      {"'\\X\\FC'", "\u00fc"},
      {"'\\S\\|'", "\u00fc"},
      {"'\\PA\\x\\\\y'", "x\\y"},
      {"'\\X2\\00F'", ""},
      {"'\\X\\0A'", "?"},
      {"$", ""},
  };
  for (const auto& [value, text] : cases) {
    EXPECT_EQ(step_string(value), text) << value;
  }
}

TEST(IfcMaterials, PartsHaveTheMaterialOfTheirWhole) {
  const auto elements = ifc_elements(
      step_of("#1=IFCROOF('0000000000000000000001',$,'roof',$,$,$,$,$,$);\n"
              "#2=IFCSLAB('0000000000000000000002',$,'slab',$,$,$,$,$,$);\n"
              "#3=IFCRELAGGREGATES('0000000000000000000003',$,$,$,#1,(#2));\n"
              "#4=IFCMATERIAL('Beton');\n"
              "#5=IFCRELASSOCIATESMATERIAL('0000000000000000000005',$,$,$,(#1),#4);\n"));
  EXPECT_EQ(elements.at("0000000000000000000002").name, "slab");
  EXPECT_EQ(elements.at("0000000000000000000002").material, "Beton");
}

}  // namespace
}  // namespace rayloc::ifc_test
