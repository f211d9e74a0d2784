// An office as IFC 2x3, and files on which the library assimp would end the process.
#include <algorithm>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

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

// Empty if the entities pass the check.
std::string fault_of(const std::string& entities) {
  const auto checked = check_ifc(step_of(entities), "x.ifc");
  return checked ? "" : checked.error().message;
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
      {with_entity("#28", "#28=IFCPRODUCTDEFINITIONSHAPE($,$);"), "too few attributes"},
      {with_entity("#26", "#26=IFCEXTRUDEDAREASOLID(#23,*,#7,200.0);"), "'*'"},
      {with_entity("#26", "#26=IFCREVOLVEDAREASOLID(#23,#25,#7,1.E10);"), "the angle 1.E10"},
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
  for (const char* schema : {"IFC5", "IFC2X2_FINAL", "IFC2X"}) {
    const std::string error = refusal("x.ifc", with(office(), "IFC2X3", schema));
    EXPECT_NE(error.find(schema), std::string::npos) << error;
    EXPECT_NE(error.find("IFC 2x3 and IFC 4"), std::string::npos) << error;
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
      {with(text, "#2=", "#2=/ *"), "has a '/'"},
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

// Forty curves of two segments, each of which has the next curve, are 2^40 curves.
TEST(IfcCheck, RepeatedCurvesAreRefused) {
  const auto curves = [](int count) {
    std::string entities = "#1=IFCPOLYLINE($);\n";
    for (int id = 2; id <= count; ++id) {
      entities += fmt::format("#{}=IFCCOMPOSITECURVE((#{},#{}),.F.);\n", id, 100 + id, 200 + id);
      for (const int segment : {100 + id, 200 + id}) {
        entities +=
            fmt::format("#{}=IFCCOMPOSITECURVESEGMENT(.CONTINUOUS.,.T.,#{});\n", segment, id - 1);
      }
    }
    return entities;
  };
  EXPECT_NE(fault_of(curves(40)).find("has the same curves many times"), std::string::npos);
  EXPECT_EQ(fault_of(curves(10)), "");
}

TEST(IfcCheck, AnglesAreLimited) {
  const auto unit = [](const std::string& value) {
    return "#1=IFCSIUNIT(*,.PLANEANGLEUNIT.,$,.RADIAN.);\n#2=IFCMEASUREWITHUNIT(" + value +
           ",#1);\n#3=IFCCONVERSIONBASEDUNIT($,.PLANEANGLEUNIT.,'DEGREE',#2);\n"
           "#4=IFCCONVERSIONBASEDUNIT($,.PLANEANGLEUNIT.,'DEGREE',#2);\n";
  };
  for (const char* value :
       {"IFCPLANEANGLEMEASURE(0.0174532925199433)", "IFCPLANEANGLEMEASURE(+1.)", "0.0157", "10."}) {
    EXPECT_EQ(fault_of(unit(value)), "") << value;
  }
  for (const char* value : {"IFCPLANEANGLEMEASURE(1.E9)",
                            "10.1",
                            "0.",
                            "-1.",
                            "NAN",
                            "1.E-999",
                            "$",
                            "IFCREAL(IFCREAL(1.))"}) {
    const std::string fault = fault_of(unit(value));
    EXPECT_TRUE(fault.starts_with("x.ifc:7: #2 IFCMEASUREWITHUNIT has ")) << value << fault;
  }
  EXPECT_EQ(fault_of("#1=IFCREVOLVEDAREASOLID($,$,$,-360.);\n"), "");
  for (const char* angle : {"1001.", "-1.E9", "IFCREAL(IFCREAL(1.E9))"}) {
    EXPECT_NE(fault_of(fmt::format("#1=IFCREVOLVEDAREASOLID($,$,$,{});\n", angle)).find("angle"),
              std::string::npos)
        << angle;
  }
}

TEST(IfcCheck, MessagesHaveALimitedTextOfTheFile) {
  const std::string text(1000, '1');
  const std::vector<std::string> faults = {
      fault_of("#1=IFCPOLYLINE(#2);\n#2=IFC" + text + "();\n"),
      fault_of("#1=IFCPRODUCTDEFINITIONSHAPE($,$,('" + text + "'));\n"),
      fault_of("#1=IFCDIRECTION((" + text + "));\n"),
      fault_of("#1=IFCREVOLVEDAREASOLID($,$,$,IFCREAL(1" + std::string(1000, '0') + "));\n"),
  };
  for (const std::string& fault : faults) {
    EXPECT_NE(fault.find("..."), std::string::npos) << fault;
    EXPECT_LT(fault.size(), 250U) << fault;
  }
  // The fortieth byte is the second one of a character.
  const auto step =
      StepText::parse(with(file_of(""), "IFC2X3", std::string(39, 'X') + "\u00fc" + text), "x.ifc");
  ASSERT_TRUE(step);
  const auto checked = check_ifc(*step, "x.ifc");
  ASSERT_FALSE(checked);
  EXPECT_NE(checked.error().message.find("'" + std::string(39, 'X') + "...'"), std::string::npos)
      << checked.error().message;
}

TEST(IfcUnits, AreFiniteAndAboveZero) {
  const auto metres = [](const std::string& value, const std::string& prefix) {
    return ifc_metres(step_of("#1=IFCSIUNIT(*,.LENGTHUNIT.," + prefix +
                              ",.METRE.);\n#2=IFCMEASUREWITHUNIT(" + value +
                              ",#1);\n#3=IFCCONVERSIONBASEDUNIT($,.LENGTHUNIT.,'x',#2);\n"
                              "#4=IFCUNITASSIGNMENT((#1,#3));\n"));
  };
  EXPECT_EQ(metres("IFCLENGTHMEASURE(304.8)", ".MILLI."), 304.8 * 1e-3);
  EXPECT_EQ(metres("0.3048", "$"), 0.3048);
  EXPECT_EQ(metres("INF", "$"), 1.0);
  EXPECT_EQ(metres("NAN", "$"), 1.0);
  EXPECT_EQ(metres("IFCLENGTHMEASURE(1E308)", ".KILO."), 1.0);
  EXPECT_EQ(metres("1E-323", ".MILLI."), 1.0);
  EXPECT_EQ(metres("-1.", "$"), 1.0);
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

TEST(IfcMaterials, OnlyLayersHaveAThickness) {
  const auto elements = ifc_elements(
      step_of("#1=IFCWALL('0000000000000000000001',$,'wall',$,$,$,$,$);\n"
              "#2=IFCMATERIAL('Beton');\n#3=IFCMATERIAL('Holz');\n"
              "#4=IFCMATERIALLAYER(#2,9.,$);\n#5=IFCMATERIALLAYER(#3,10.,$);\n"
              "#6=IFCPROPERTYSINGLEVALUE(#3,100.,$,$);\n#7=IFCMATERIALLAYER($,50.,$);\n"
              "#8=IFCMATERIALLAYERSET((#4,#6,#5,#7,#5),$);\n"
              "#9=IFCMATERIALLAYERSETUSAGE(#8,.AXIS2.,.POSITIVE.,0.);\n"
              "#10=IFCRELASSOCIATESMATERIAL('0000000000000000000010',$,$,$,(#1),#9);\n"));
  EXPECT_EQ(elements.at("0000000000000000000001").material, "Holz");
}

TEST(IfcMaterials, ConstituentsAndProfilesAreRead) {
  const auto elements = ifc_elements(
      step_of("#1=IFCWINDOW('0000000000000000000001',$,'window',$,$,$,$,$);\n"
              "#2=IFCCOLUMN('0000000000000000000002',$,'column',$,$,$,$,$);\n"
              "#3=IFCDOOR('0000000000000000000003',$,'door',$,$,$,$,$);\n"
              "#4=IFCMATERIAL('Holz',$,$);\n#5=IFCMATERIAL('Glas',$,$);\n#6=IFCMATERIAL('Stahl');\n"
              "#7=IFCMATERIALCONSTITUENT('Framing',$,#4,0.2,$);\n"
              "#8=IFCMATERIALCONSTITUENT('Glazing',$,#5,0.8,$);\n"
              "#9=IFCMATERIALCONSTITUENTSET('x',$,(#7,#8));\n"
              "#10=IFCMATERIALPROFILE('x',$,#6,$,$,$);\n"
              "#11=IFCMATERIALPROFILESET('x',$,(#10),$);\n"
              "#12=IFCMATERIALPROFILESETUSAGE(#11,5,$);\n"
              "#13=IFCMATERIALCONSTITUENT('Framing',$,#4,$,$);\n"
              "#14=IFCMATERIALCONSTITUENT('Glazing',$,#5,$,$);\n"
              "#15=IFCMATERIALCONSTITUENTSET('x',$,(#13,#14));\n"
              "#16=IFCRELASSOCIATESMATERIAL('0000000000000000000016',$,$,$,(#1),#9);\n"
              "#17=IFCRELASSOCIATESMATERIAL('0000000000000000000017',$,$,$,(#2),#12);\n"
              "#18=IFCRELASSOCIATESMATERIAL('0000000000000000000018',$,$,$,(#3),#15);\n"));
  EXPECT_EQ(elements.at("0000000000000000000001").material, "Glas");
  EXPECT_EQ(elements.at("0000000000000000000002").material, "Stahl");
  EXPECT_EQ(elements.at("0000000000000000000003").material, "Holz");
}

// Without a memory of what was read: 4e8 layers.
TEST(IfcMaterials, ALayerSetIsReadOnce) {
  constexpr int kElements = 20'000;
  std::string entities =
      "#1=IFCMATERIAL('Beton');\n#2=IFCMATERIALLAYER(#1,9.,$);\n#3=IFCMATERIALLAYERSET((#2";
  for (int i = 1; i < kElements; ++i) {
    entities += ",#2";
  }
  entities += "),$);\n";
  for (int i = 0; i < kElements; ++i) {
    entities += fmt::format("#{}=IFCWALL('{:022}',$,'wall',$,$,$,$,$);\n", 100'000 + i, i);
    entities += fmt::format("#{}=IFCMATERIALLAYERSETUSAGE(#3,.AXIS2.,$,0.);\n", 200'000 + i);
    entities += fmt::format("#{}=IFCRELASSOCIATESMATERIAL('',$,$,$,(#{}),#{});\n",
                            300'000 + i,
                            100'000 + i,
                            200'000 + i);
  }
  const auto elements = ifc_elements(step_of(entities));
  EXPECT_EQ(elements.at(fmt::format("{:022}", kElements - 1)).material, "Beton");
}

TEST(IfcMaterials, ANameIsLimited) {
  const auto elements = ifc_elements(
      step_of("#1=IFCWALL('0000000000000000000001',$,'wall',$,$,$,$,$);\n#2=IFCMATERIAL('" +
              std::string(2000, 'x') +
              "');\n#3=IFCRELASSOCIATESMATERIAL('0000000000000000000003',$,$,$,(#1),#2);\n"));
  EXPECT_EQ(elements.at("0000000000000000000001").material, "");
}

}  // namespace
}  // namespace rayloc::ifc_test
