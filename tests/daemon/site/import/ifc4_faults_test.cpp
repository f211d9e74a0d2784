// Content of an IFC 4 file that is not read is reported; faults are refused.
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/ifc/ifc4.h"
#include "daemon/site/import/ifc/ifc_check.h"
#include "daemon/site/import/import_scene.h"
#include "tests/daemon/site/import/ifc4_files.h"

namespace rayloc::ifc4_faults_test {
namespace {

using test::area_of;
using test::kBoxArea;
using test::kBoxPoints;
using test::kBoxTriangles;
using test::kExtrusion;
using test::with_item;

class Ifc4Faults : public test::Ifc4Files {};

TEST_F(Ifc4Faults, ShapesThatAreNotReadAreReported) {
  const std::string box =
      kBoxPoints + "#31=IFCTRIANGULATEDFACESET(#20,$,.T.," + kBoxTriangles + ",$);\n";
  // One of two items.
  std::string content = with_item(box + "#30=IFCADVANCEDBREP(#99);\n");
  content.replace(content.find("(#30));"), 7, "(#31,#30));");
  std::string remarks;
  EXPECT_NEAR(area_of(part_of(content, &remarks).mesh), kBoxArea, 1e-5);
  EXPECT_NE(remarks.find("IFCADVANCEDBREP"), std::string::npos) << remarks;
  EXPECT_NE(remarks.find("#50 IFCWALL 'part'"), std::string::npos) << remarks;
  // A part of a shape, deep within it.
  remarks.clear();
  part_of(with_item("#21=IFCRECTANGLEPROFILEDEF(.AREA.,$,$,3.,0.2);\n"
                    "#31=IFCEXTRUDEDAREASOLID(#21,$,#13,2.);\n#32=IFCSPHERE(#2,0.3);\n"
                    "#30=IFCBOOLEANRESULT(.DIFFERENCE.,#31,#32);\n"),
          &remarks);
  EXPECT_NE(remarks.find("1 with IFCSPHERE"), std::string::npos) << remarks;
  // The only one.
  const std::string error =
      refusal("x.ifc", with_item("#30=IFCEXTRUDEDAREASOLIDTAPERED(#1,$,#13,2.,#2);\n"));
  EXPECT_NE(error.find("IFCEXTRUDEDAREASOLIDTAPERED"), std::string::npos) << error;
  EXPECT_NE(error.find("Reference View"), std::string::npos) << error;
}

TEST_F(Ifc4Faults, ElementsAtOtherPlacementsAreReported) {
  const std::string content =
      with_item(kBoxPoints + "#30=IFCTRIANGULATEDFACESET(#20,$,.T.," + kBoxTriangles +
                ",$);\n#60=IFCLINEARPLACEMENT($,$,$);\n"
                "#61=IFCWALL('0000000000000000000061',$,'other',$,$,#60,#41,$,$);\n");
  std::string remarks;
  part_of(content, &remarks);
  EXPECT_NE(remarks.find("IFCLINEARPLACEMENT"), std::string::npos) << remarks;
}

TEST_F(Ifc4Faults, ElementsOutsideEveryStoreyAreReported) {
  std::string content =
      with_item(kBoxPoints + "#30=IFCTRIANGULATEDFACESET(#20,$,.T.," + kBoxTriangles +
                ",$);\n#61=IFCWALL('0000000000000000000061',$,'lost wall',$,$,#7,#41,$,$);\n");
  std::string remarks;
  part_of(content, &remarks);
  EXPECT_NE(remarks.find("lost wall"), std::string::npos) << remarks;
}

// assimp cuts openings from extrusions only; 'Reference' is an opening that the shape has already.
TEST_F(Ifc4Faults, OpeningsThatAreNotCutAreReported) {
  const auto content = [](const std::string& identifier) {
    return with_item(kBoxPoints + "#30=IFCTRIANGULATEDFACESET(#20,$,.T.," + kBoxTriangles +
                     ",$);\n#21=IFCRECTANGLEPROFILEDEF(.AREA.,$,$,1.,1.);\n"
                     "#60=IFCEXTRUDEDAREASOLID(#21,$,#13,2.);\n#61=IFCSHAPEREPRESENTATION(#3,'" +
                     identifier +
                     "','SweptSolid',(#60));\n#62=IFCPRODUCTDEFINITIONSHAPE($,$,(#61));\n"
                     "#63=IFCOPENINGELEMENT('0000000000000000000063',$,'o',$,$,#7,#62,$,$);\n"
                     "#64=IFCRELVOIDSELEMENT('0000000000000000000064',$,$,$,#50,#63);\n");
  };
  std::string remarks;
  part_of(content("Body"), &remarks);
  EXPECT_NE(remarks.find("not cut"), std::string::npos) << remarks;
  remarks.clear();
  part_of(content("Reference"), &remarks);
  EXPECT_EQ(remarks.find("not cut"), std::string::npos) << remarks;
}

TEST_F(Ifc4Faults, FaultsAreRefusedWithTheirLine) {
  const std::string points = "#20=IFCCARTESIANPOINTLIST3D(((0.,0.,0.),(1.,0.,0.),(1.,1.,0.)));\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {points + "#30=IFCTRIANGULATEDFACESET(#20,$,.T.,((1,2,4)),$);\n", "x.ifc:20: #30"},
      {points + "#30=IFCTRIANGULATEDFACESET(#20,$,.T.,((0,1,2)),$);\n", "index '0'"},
      {points + "#30=IFCTRIANGULATEDFACESET(#20,$,.T.,((1,2,'x')),$);\n", "index"},
      {points + "#30=IFCTRIANGULATEDFACESET(#20,$,.T.,((1,2)),$);\n", "three points"},
      {points + "#30=IFCTRIANGULATEDFACESET(#20,$,.T.,((1,2,3)),(1,2,9));\n", "index '9'"},
      {points + "#30=IFCTRIANGULATEDFACESET(#13,$,.T.,((1,2,3)),$);\n", "no list of points"},
      {points + "#30=IFCTRIANGULATEDFACESET(#20,$);\n", "too few attributes"},
      {points + "#30=IFCTRIANGULATEDFACESET(#98,$,.T.,((1,2,3)),$);\n",
       "#98, which does not exist"},
      {points + "#30=IFCTRIANGULATEDFACESET($,$,.T.,((1,2,3)),$);\n", "no reference"},
      {points + "#30=IFCPOLYGONALFACESET(#20,.T.,(#97),$);\n", "#97, which does not exist"},
      {points + "#30=IFCPOLYGONALFACESET(#20,.T.,(#13),$);\n", "no face"},
      {"#20=IFCCARTESIANPOINTLIST3D(((0.,0.,x)));\n"
       "#30=IFCTRIANGULATEDFACESET(#20,$,.T.,((1,1,1)),$);\n",
       "'x' where a number"},
      {"#20=IFCCARTESIANPOINTLIST3D(((0.)));\n"
       "#30=IFCTRIANGULATEDFACESET(#20,$,.T.,((1,1,1)),$);\n",
       "two or three numbers"},
      {"#20=IFCCARTESIANPOINTLIST3D(());\n#30=IFCTRIANGULATEDFACESET(#20,$,.T.,((1,1,1)),$);\n",
       "no points"},
      {"#21=IFCRECTANGLEPROFILEDEF(.AREA.,$,$,INF,1.);\n" + kExtrusion, "'INF' where a number"},
      {"#21=IFCRECTANGLEPROFILEDEF(.AREA.,$,$,1.E30,1.);\n" + kExtrusion, "1.E30"},
      {"#21=IFCRECTANGLEPROFILEDEF(.AREA.,$,#13,1.,1.);\n" + kExtrusion, "no placement"},
      {"#21=IFCRECTANGLEPROFILEDEF($,$,$,1.,1.);\n" + kExtrusion, "keyword"},
      {"#30=IFCEXTRUDEDAREASOLID(#13,$,#13,2.);\n", "#13 IFCDIRECTION, which is no profile"},
      {"#30=IFCBOOLEANRESULT(.DIFFERENCE.,#30,#30);\n", "a cycle"},
      {"#22=IFCCARTESIANPOINTLIST2D(((0.,0.),(1.,0.)));\n"
       "#23=IFCINDEXEDPOLYCURVE(#22,(IFCARCINDEX((1,2))),$);\n"
       "#21=IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#23);\n" +
           kExtrusion,
       "another number of points"},
      {"#22=IFCCARTESIANPOINTLIST2D(((0.,0.),(1.,0.)));\n"
       "#23=IFCINDEXEDPOLYCURVE(#22,((1,2)),$);\n"
       "#21=IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#23);\n" +
           kExtrusion,
       "neither IFCLINEINDEX nor IFCARCINDEX"},
  };
  for (const auto& [entities, message] : cases) {
    const auto imported = import(file("x.ifc", with_item(entities)));
    ASSERT_FALSE(imported) << message;
    EXPECT_EQ(imported.error().kind, ErrorKind::kBadInput);
    EXPECT_NE(imported.error().message.find(message), std::string::npos)
        << imported.error().message;
    EXPECT_NE(imported.error().message.find("x.ifc:"), std::string::npos);
  }
}

TEST_F(Ifc4Faults, FaultsOfTheStructureAreRefused) {
  const std::string box =
      kBoxPoints + "#30=IFCTRIANGULATEDFACESET(#20,$,.T.," + kBoxTriangles + ",$);\n";
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string content = with_item(box);
    return content.replace(content.find(from), from.size(), to);
  };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {changed("#6=IFCPROJECT", "#6=IFCPROJEKT"), "IfcProject"},
      {changed("#7=IFCLOCALPLACEMENT($", "#7=IFCLOCALPLACEMENT(#7"), "a cycle"},
      {changed("(#50),#9", "(#50,#77),#9"), "#77, which does not exist"},
      {changed("(#8));", "(#6));"), "a part of its own part"},
      {changed(",$,(#40));", ");"), "too few attributes"},
      {changed("(#40));", "(#78));"), "#78, which does not exist"},
      {changed("#7,#41,$,$);", "#7,#2,$,$);"), "no shape"},
  };
  for (const auto& [content, message] : cases) {
    const std::string error = refusal("x.ifc", content);
    EXPECT_NE(error.find(message), std::string::npos) << message << ": " << error;
  }
}

StepText step_of(const std::string& entities) {
  auto step = StepText::parse(with_item(entities), "x.ifc");
  EXPECT_TRUE(step) << step.error().message;
  return step ? *std::move(step) : StepText();
}

TEST(Ifc4Text, NestedReferencesHaveALimit) {
  std::string entities = "#1000=IFCSPHERE(#2,1.);\n";
  for (int id = 1001; id < 101'000; ++id) {
    entities += fmt::format("#{}=IFCBOOLEANRESULT(.UNION.,#{},#{});\n", id, id - 1, id - 1);
  }
  const auto made = ifc4_as_2x3(step_of(entities + "#30=IFCCSGSOLID(#100999);\n"), "x.ifc");
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().message.find("nested"), std::string::npos) << made.error().message;
}

// Forty levels, each of which has the next one twice, are 2^40 shapes.
TEST(Ifc4Text, RepeatedReferencesAreReadOnce) {
  std::string entities =
      "#1000=IFCEXTRUDEDAREASOLID(#1041,$,#13,1.);\n"
      "#1041=IFCCIRCLEPROFILEDEF(.AREA.,$,$,1.);\n";
  for (int id = 1001; id <= 1040; ++id) {
    entities += fmt::format("#{}=IFCBOOLEANRESULT(.UNION.,#{},#{});\n", id, id - 1, id - 1);
  }
  const auto made = ifc4_as_2x3(step_of(entities + "#30=IFCCSGSOLID(#1040);\n"), "x.ifc");
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(check_ifc(made->step, "x.ifc"));
  EXPECT_NE(made->remarks.at(0).find("IFCBOOLEANRESULT"), std::string::npos);
}

TEST(Ifc4Text, OtherEntitiesAreLeftOut) {
  const auto made = ifc4_as_2x3(
      step_of("#60=IFCPROPERTYSET('0000000000000000000060',$,'x',$,(#98));\n"
              "#61=IFCANNOTATION('0000000000000000000061',$,'x',$,$,#7,$);\n"
              "#62=IFCSTYLEDITEM(#98,(#97),$);\n#63=(IFCA()IFCB());\n#30=IFCSPHERE(#2,1.);\n"),
      "x.ifc");
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_EQ(plain_ifc(made->step).find("'x'"), std::string::npos);
  EXPECT_TRUE(made->shaped.empty());
}

}  // namespace
}  // namespace rayloc::ifc4_faults_test
