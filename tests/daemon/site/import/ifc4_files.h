// Files of IFC 4 with one element, and what becomes of them.
#pragma once

#include <string>

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/read_model.h"
#include "engine/scene/mesh.h"
#include "tests/daemon/site/import/import_files.h"

namespace rayloc::test {

inline double area_of(const Mesh& mesh) {
  double area = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3d& p = mesh.vertices[a];
    area += 0.5 * norm(cross(mesh.vertices[b] - p, mesh.vertices[c] - p));
  }
  return area;
}

// A storey in metres with one element, #50, whose representation #40 has the item #30.
inline std::string with_item(const std::string& entities,
                             const std::string& schema = "IFC4",
                             const std::string& element = "IFCWALL") {
  return "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('" + schema +
         "'));\nENDSEC;\nDATA;\n"
         "#1=IFCCARTESIANPOINT((0.,0.,0.));\n#2=IFCAXIS2PLACEMENT3D(#1,$,$);\n"
         "#3=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#2,$);\n"
         "#4=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);\n#5=IFCUNITASSIGNMENT((#4));\n"
         "#6=IFCPROJECT('0000000000000000000006',$,'p',$,$,$,$,(#3),#5);\n"
         "#7=IFCLOCALPLACEMENT($,#2);\n"
         "#8=IFCBUILDING('0000000000000000000008',$,'b',$,$,#7,$,$,$,$,$,$);\n"
         "#9=IFCBUILDINGSTOREY('0000000000000000000009',$,'s',$,$,#7,$,$,$,0.);\n"
         "#10=IFCRELAGGREGATES('0000000000000000000010',$,$,$,#6,(#8));\n"
         "#11=IFCRELAGGREGATES('0000000000000000000011',$,$,$,#8,(#9));\n"
         "#12=IFCRELCONTAINEDINSPATIALSTRUCTURE('0000000000000000000012',$,$,$,(#50),#9);\n"
         "#13=IFCDIRECTION((0.,0.,1.));\n" +
         entities +
         "#40=IFCSHAPEREPRESENTATION(#3,'Body','Tessellation',(#30));\n"
         "#41=IFCPRODUCTDEFINITIONSHAPE($,$,(#40));\n#50=" +
         element +
         "('0000000000000000000050',$,'part',$,$,#7,#41,$,$);\n"
         "ENDSEC;\nEND-ISO-10303-21;\n";
}

// A box of 3 x 0.2 x 2.5 m by the index of its corners, with the arguments of its faces.
inline const std::string kBoxPoints =
    "#20=IFCCARTESIANPOINTLIST3D(((0.,0.,0.),(3.,0.,0.),(3.,0.2,0.),(0.,0.2,0.),(0.,0.,2.5),(3.,0.,"
    "2.5),(3.,0.2,2.5),(0.,0.2,2.5)));\n";
inline const std::string kBoxTriangles =
    "((1,3,2),(1,4,3),(5,6,7),(5,7,8),(1,2,6),(1,6,5),(2,3,7),(2,7,6),(3,4,8),(3,8,7),(4,1,5),(4,5,"
    "8))";
inline constexpr double kBoxArea = 2.0 * (3.0 * 0.2 + 3.0 * 2.5 + 0.2 * 2.5);

// An extrusion of #21 by 2 m along z.
inline const std::string kExtrusion = "#30=IFCEXTRUDEDAREASOLID(#21,$,#13,2.);\n";

class Ifc4Files : public ImportFiles {
 protected:
  // The one part of a model; its remarks are appended to `remarks`.
  ModelPart part_of(const std::string& content, std::string* remarks = nullptr) const {
    const auto model = read_model(file("x.ifc", content), ModelFormat::kIfc, {0.0, 'y'});
    EXPECT_TRUE(model) << model.error().message;
    if (!model) {
      return {};
    }
    EXPECT_EQ(model->parts.size(), 1U);
    if (remarks != nullptr) {
      *remarks += fmt::format("{}", fmt::join(model->remarks, "\n"));
    }
    return model->parts.empty() ? ModelPart() : model->parts.front();
  }
};

}  // namespace rayloc::test
