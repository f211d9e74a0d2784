// Flat drawings: read, their walls found, and drawn up to a room.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/drawn_plan.h"
#include "daemon/site/import/import_scene.h"
#include "daemon/site/import/wall_lines.h"
#include "tests/daemon/site/import/import_files.h"

namespace rayloc::dxf_test {
namespace {

namespace fs = std::filesystem;

// By ezdxf, a program of other people: an office of 6 x 4 m whose outer walls have two faces, an
// inner wall, a window drawn as two panes, a door, a desk as a block that is rotated, a text.
constexpr const char* kWriter = R"(
import sys, ezdxf
d = ezdxf.new(sys.argv[2]); d.header['$INSUNITS'] = 4
m = d.modelspace()
def rect(x0, y0, x1, y1, layer):
    points = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    if sys.argv[2] == 'R12':
        m.add_polyline2d(points, close=True, dxfattribs={'layer': layer})
    else:
        m.add_lwpolyline(points, close=True, dxfattribs={'layer': layer})
rect(1000, 2000, 7000, 6000, 'A-WALL'); rect(800, 1800, 7200, 6200, 'A-WALL')
m.add_line((4000, 2000), (4000, 4500), dxfattribs={'layer': 'A-WALL'})
m.add_line((2000, 1870), (3500, 1870), dxfattribs={'layer': 'A-GLAZ'})
m.add_line((2000, 1930), (3500, 1930), dxfattribs={'layer': 'A-GLAZ'})
m.add_arc((4000, 4500), 900, 0, 90, dxfattribs={'layer': 'A-DOOR'})
m.add_text('Office', dxfattribs={'layer': 'A-ANNO'})
b = d.blocks.new('DESK'); b.add_line((0, 0), (1600, 0))
b.add_polyline2d([(0, 0), (1600, 0), (1600, 800), (0, 800)], close=True)
m.add_blockref('DESK', (6800, 2200), dxfattribs={'layer': 'FURNITURE', 'rotation': 90})
d.saveas(sys.argv[1])
)";

class Dxf : public test::ImportFiles {
 protected:
  std::string refusal(const std::string& content) const {
    return ImportFiles::refusal("plan.dxf", content);
  }
  // Entities of a drawing.
  static std::string drawing(const std::string& entities) {
    return "0\nSECTION\n2\nENTITIES\n" + entities + "0\nENDSEC\n0\nEOF\n";
  }
  static std::string line(const std::string& layer, double x0, double y0, double x1, double y1) {
    return fmt::format("0\nLINE\n8\n{}\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n", layer, x0, y0, x1, y1);
  }
  // A table of layers: names, flags (1: frozen) and colours (below 0: off).
  struct Listed {
    std::string name;
    int flags = 0;
    int colour = 7;
  };
  static std::string tables(const std::vector<Listed>& layers) {
    std::string text = "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n";
    for (const Listed& layer : layers) {
      text +=
          fmt::format("0\nLAYER\n2\n{}\n70\n{}\n62\n{}\n", layer.name, layer.flags, layer.colour);
    }
    return text + "0\nENDTAB\n0\nENDSEC\n";
  }
  // The walls of a room of 6 x 4 m.
  static std::string walls(const std::string& layer) {
    return line(layer, 0, 0, 6, 0) + line(layer, 6, 0, 6, 4) + line(layer, 6, 4, 0, 4) +
           line(layer, 0, 4, 0, 0);
  }
};

const StatedObject* object_of(const ImportedScene& scene, const std::string& name) {
  const auto found = std::find_if(scene.scene.objects.begin(),
                                  scene.scene.objects.end(),
                                  [&](const StatedObject& one) { return one.name == name; });
  return found == scene.scene.objects.end() ? nullptr : &*found;
}

double thickness_of(const ImportedScene& scene, const StatedObject& object) {
  for (const StatedMaterial& material : scene.scene.materials) {
    if (material.name == object.material) {
      return material.thickness;
    }
  }
  return 0.0;
}

TEST_F(Dxf, ADrawingOfAnotherProgramBecomesARoom) {
  if (std::system("/usr/bin/python3 -c 'import ezdxf' 2> /dev/null") != 0) {
    GTEST_SKIP() << "ezdxf (Debian: python3-ezdxf) is not installed";
  }
  const fs::path writer = file("writer.py", kWriter);
  for (const std::string version : {"R12", "R2010", "R2018"}) {
    const fs::path made = folder_ / (version + ".dxf");
    ASSERT_EQ(std::system(("/usr/bin/python3 " + writer.string() + " " + made.string() + " " +
                           version + " 2> /dev/null")
                              .c_str()),
              0);
    const auto room = import(made);
    ASSERT_TRUE(room) << room.error().message;
    // The room spans the outer faces; walls lie between their two faces.
    EXPECT_NEAR(room->bounds.size().x, 6.4, 1e-9) << version;
    EXPECT_NEAR(room->bounds.size().y, 4.4, 1e-9);
    EXPECT_NEAR(room->bounds.size().z, kUsualHeight, 1e-9);
    const StatedObject* const wall = object_of(*room, "A-WALL");
    ASSERT_NE(wall, nullptr);
    EXPECT_NEAR(thickness_of(*room, *wall), 0.2, 1e-9);
    const StatedObject* const window = object_of(*room, "A-GLAZ");
    ASSERT_NE(window, nullptr) << "two panes are one window";
    EXPECT_EQ(object_of(*room, "A-GLAZ_2"), nullptr);
    EXPECT_EQ(window->material, "glass");
    EXPECT_NEAR(window->mesh.vertices[0].y, 0.1, 1e-9);
    EXPECT_NEAR(window->mesh.vertices[0].z, kSill, 1e-9);
    const StatedObject* const desk = object_of(*room, "FURNITURE");
    ASSERT_NE(desk, nullptr);
    for (const Vec3d& v : desk->mesh.vertices) {  // rotated about its corner, at 6.8, 2.2 m
      EXPECT_GT(v.x, 5.199);
      EXPECT_LT(v.x, 6.001);
      EXPECT_GT(v.y, 0.399);
      EXPECT_LT(v.y, 2.001);
    }
    const std::string text = remarks(*room);
    EXPECT_NE(text.find("1 TEXT"), std::string::npos) << text;
  }
}

TEST_F(Dxf, AcceptsAStatedUnitAndHeight) {
  const std::string walls = drawing(line("Wand", 0, 0, 12, 0) + line("Wand", 12, 0, 12, 9));
  const auto feet = import(file("plan.dxf", walls), {{0.3048, '\0', 3.1}, 0.0});
  ASSERT_TRUE(feet) << feet.error().message;
  EXPECT_NEAR(feet->bounds.size().x, 12 * 0.3048, 1e-9);
  EXPECT_NEAR(feet->bounds.size().z, 3.1, 1e-9);
  const auto metres = import(file("plan.dxf", walls));
  ASSERT_TRUE(metres);
  EXPECT_NEAR(metres->bounds.size().x, 12.0, 1e-9);
}

TEST_F(Dxf, RefusesInvalidPlansWithARemedy) {
  EXPECT_EQ(refusal("AutoCAD Binary DXF\r\n\x1a"),
            "plan.dxf: is a DXF in binary; export it as DXF of text (ASCII)");
  EXPECT_EQ(refusal("0\nSECTION\n2\nENTITIES\nzero\nLINE\n"),
            "plan.dxf:5: 'zero' is no group code of a DXF; export it again as DXF (text)");
  EXPECT_EQ(refusal("0\nSECTION\n2\nENTITIES\n0\nLINE\n10\n1,5\n"),
            "plan.dxf:7: '1,5' is no number; export it again as DXF (text)");
  EXPECT_EQ(refusal("0\nSECTION\n2\nENTITIES\n0\nLINE\n10\n"),
            "plan.dxf:7: the file ends within a group; export it again as DXF (text)");
  EXPECT_NE(refusal("0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nb\n10\n1e300\n" +
                    line("wall", 1e300, 0, 2e300, 0) + "0\nENDBLK\n0\nENDSEC\n" +
                    drawing("0\nINSERT\n2\nb\n41\n1e300\n"))
                .find("not a finite number"),
            std::string::npos);
  EXPECT_NE(refusal(drawing("0\nTEXT\n1\nhello\n"))
                .find("has no line that can be seen: left out: 1 TEXT"),
            std::string::npos);
  const std::string unknown = refusal(drawing(line("X7", 0, 0, 3, 0) + line("Y", 0, 0, 0, 3)));
  EXPECT_NE(unknown.find("no layer is known to hold walls; its layers are X7, Y."),
            std::string::npos)
      << unknown;
  const auto large = import(file("plan.dxf", drawing(line("wall", 0, 0, 12000, 0))), {{1.0}, 0.0});
  ASSERT_FALSE(large);
  EXPECT_NE(large.error().message.find("would be 12000 m long"), std::string::npos);
}

TEST_F(Dxf, PartsThatAPersonDoesNotSeeAreLeftOutAndCounted) {
  const std::string block = "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nb\n" + line("WALL", 0, 0, 30, 0) +
                            "0\nENDBLK\n0\nENDSEC\n";
  const auto room = import(file(
      "plan.dxf",
      tables({{"WALL"}, {"WALL-DEMO", 1}, {"WALL-OLD", 0, -3}, {"GRID", 1}}) + block +
          drawing(walls("WALL") + line("WALL-DEMO", 0, 0, 40, 0) + line("WALL-OLD", 0, 0, 0, 40) +
                  "0\nINSERT\n8\nGRID\n2\nb\n" + line("WALL", 0, 0, 50, 0) + "67\n1\n" +
                  line("WALL", 0, 0, 0, 50) + "60\n1\n")));
  ASSERT_TRUE(room) << room.error().message;
  EXPECT_NEAR(room->bounds.size().x, 6.0, 1e-9);
  EXPECT_NEAR(room->bounds.size().y, 4.0, 1e-9);
  const std::string text = remarks(*room);
  EXPECT_NE(text.find("3 on layers that are off or frozen (GRID, WALL-DEMO, WALL-OLD)"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("1 in the layout of a sheet"), std::string::npos) << text;
  EXPECT_NE(text.find("1 invisible"), std::string::npos) << text;
}

TEST_F(Dxf, WallsThatAreEmptyOrHiddenAreNamed) {
  const std::string empty = refusal(tables({{"WALLS"}, {"X7"}}) + drawing(walls("X7")));
  EXPECT_NE(empty.find("layer 'WALLS' is empty"), std::string::npos) << empty;
  const std::string hidden =
      refusal(tables({{"WALLS", 1}, {"X7"}}) + drawing(walls("X7") + walls("WALLS")));
  EXPECT_NE(hidden.find("layer 'WALLS' is off or frozen"), std::string::npos) << hidden;
  // Its walls are of a kind that is not read, so the layer is not empty.
  const std::string unread =
      refusal(tables({{"WALLS"}, {"X7"}}) + drawing(walls("X7") + "0\n3DFACE\n8\nWALLS\n10\n1\n"));
  EXPECT_NE(unread.find("its layers are X7."), std::string::npos) << unread;
  EXPECT_NE(unread.find("left out: 1 3DFACE"), std::string::npos) << unread;
}

TEST_F(Dxf, NamesOfLayersAndBlocksAreComparedWithoutCase) {
  const auto room = import(
      file("plan.dxf",
           tables({{"Wall"}, {"Wall-Old", 1}}) + "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nAnnex\n" +
               line("WALL", 6, 0, 9, 0) + "0\nENDBLK\n0\nENDSEC\n" +
               drawing(walls("WALL") + line("WALL-OLD", 0, 0, 40, 0) + "0\nINSERT\n2\nANNEX\n")));
  ASSERT_TRUE(room) << room.error().message;
  EXPECT_NEAR(room->bounds.size().x, 9.0, 1e-9);
  EXPECT_NE(object_of(*room, "Wall"), nullptr) << "the name is that of the table of layers";
  auto named = MaterialTable::parse(kDefaultMaterialTable, "materials");
  ASSERT_TRUE(named);
  named->name_walls({"X7"});
  EXPECT_TRUE(import_scene(file("plan.dxf", drawing(walls("x7"))), *named, {}));
  EXPECT_NE(remarks(*room).find("(Wall-Old)"), std::string::npos) << remarks(*room);
}

TEST_F(Dxf, TheFirstOfManyNamesAreListed) {
  std::vector<Listed> hidden;
  std::string entities = walls("WALL");
  for (int i = 10; i < 50; ++i) {
    hidden.push_back({fmt::format("GRID{}", i), 1});
    entities += line(hidden.back().name, 0, 0, 1, 0) + fmt::format("0\nKIND{}\n8\nWALL\n", i);
  }
  const auto room = import(file("plan.dxf", tables(hidden) + drawing(entities)));
  ASSERT_TRUE(room) << room.error().message;
  const std::string text = remarks(*room);
  EXPECT_NE(text.find("GRID29 and 20 more"), std::string::npos) << text;
  EXPECT_NE(text.find("KIND28 and 21 more"), std::string::npos) << text;
}

TEST_F(Dxf, NamedWallsThatAreEmptyOrHiddenAreNamed) {
  auto table = MaterialTable::parse(kDefaultMaterialTable, "materials");
  ASSERT_TRUE(table);
  table->name_walls({"W1"});
  const auto refused = [&](const Listed& layer, const std::string& entities) {
    const auto room = import_scene(
        file("plan.dxf", tables({layer, {"WALLS"}}) + drawing(walls("WALLS") + entities)),
        *table,
        {});
    return room ? "" : room.error().message;
  };
  EXPECT_NE(refused({"W1"}, "").find("layer 'W1' is empty"), std::string::npos);
  EXPECT_NE(refused({"W1", 1}, walls("W1")).find("layer 'W1' is off or frozen"), std::string::npos);
  EXPECT_NE(refused({"W2"}, walls("W2")).find("no line is on a layer 'W1'; its layers are"),
            std::string::npos);
}

// As AutoCAD writes them in three versions of the format.
TEST_F(Dxf, NamesOfLayersMayHaveLettersWithAccents) {
  for (const char* name : {"W\xc4NDE", "W\\U+00C4NDE", "W\xc3\x84NDE"}) {
    const auto room = import(file("plan.dxf", drawing(walls(name))));
    ASSERT_TRUE(room) << room.error().message;
    EXPECT_NEAR(room->bounds.size().x, 6.0, 1e-9) << name;
    EXPECT_EQ(remarks(*room).find("Windows-1252") != std::string::npos,
              std::string(name) == "W\xc4NDE");
  }
  const std::string hidden =
      refusal(tables({{"T\xdcR WAND", 1}}) + drawing(walls("T\\U+00DCR WAND")));
  EXPECT_NE(hidden.find("has no line that can be seen"), std::string::npos) << hidden;
}

TEST_F(Dxf, ADrawingWithoutLayersIsReadIfItsWallsAreNamed) {
  const std::string plan = drawing(walls("0"));
  EXPECT_NE(refusal(plan).find("--walls \"0\""), std::string::npos) << refusal(plan);
  auto in_table = MaterialTable::parse("[layers]\nwall = [\"0\"]\n", "table");
  auto named = MaterialTable::parse(kDefaultMaterialTable, "materials");
  ASSERT_TRUE(in_table && named);
  named->name_walls({"0"});
  for (const MaterialTable& table : {*in_table, *named}) {
    const auto room = import_scene(file("plan.dxf", plan), table, {});
    ASSERT_TRUE(room) << room.error().message;
    EXPECT_NEAR(room->bounds.size().y, 4.0, 1e-9);
  }
  named->name_walls({"0", "O"});
  const auto mistyped = import_scene(file("plan.dxf", plan), *named, {});
  ASSERT_FALSE(mistyped);
  EXPECT_NE(mistyped.error().message.find("no line is on a layer 'O'; its layers are 0"),
            std::string::npos)
      << mistyped.error().message;
  const auto model = import_scene(file("room.obj", "o floor\nv 0 0 0\nf 1 1 1\n"), *named, {});
  ASSERT_FALSE(model);
  EXPECT_NE(model.error().message.find("--walls is of the layers of DXF and SVG"),
            std::string::npos);
}

// A drawing begun from a template states its millimetres or inches, whatever it is drawn in.
TEST_F(Dxf, AnImplausibleUnitOfTheHeaderIsReported) {
  const auto stated = [&](int unit, double side) {
    return fmt::format("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n{}\n0\nENDSEC\n", unit) +
           drawing(line("WALL", 0, 0, side, 0) + line("WALL", 0, 0, 0, side));
  };
  const std::string small = refusal(stated(4, 6));
  EXPECT_NE(small.find("would be 0.006 m long"), std::string::npos) << small;
  EXPECT_NE(small.find("--unit m"), std::string::npos) << small;
  EXPECT_TRUE(import(file("plan.dxf", stated(4, 6)), {{1.0}, 0.0}));
  const auto large = import(file("plan.dxf", stated(1, 6000)));
  ASSERT_TRUE(large) << large.error().message;
  EXPECT_NE(remarks(*large).find("warning: it is 152 m long"), std::string::npos);
  const auto usual = import(file("plan.dxf", stated(4, 6000)));
  ASSERT_TRUE(usual) << usual.error().message;
  EXPECT_EQ(remarks(*usual).find("warning"), std::string::npos) << remarks(*usual);
}

TEST_F(Dxf, RefusesMoreFurnitureThanAStoreyHas) {
  const std::string desk =
      "0\nLWPOLYLINE\n8\nDESK\n70\n1\n10\n1\n20\n1\n10\n2\n20\n1\n10\n2\n20\n2\n";
  const auto desks = [&](int count) {
    return "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nb\n" + desk + "0\nENDBLK\n0\nENDSEC\n" +
           drawing(walls("WALL") + fmt::format("0\nINSERT\n2\nb\n70\n{}\n", count));
  };
  const auto office = import(file("plan.dxf", desks(100)));
  ASSERT_TRUE(office) << office.error().message;
  EXPECT_NE(object_of(*office, "DESK_100"), nullptr) << "repeated names are numbered";
  EXPECT_EQ(object_of(*office, "DESK_101"), nullptr);
  EXPECT_NE(refusal(desks(4001)).find("closed lines of furniture"), std::string::npos);
}

// Each placed line has a copy of its layer's name.
TEST_F(Dxf, NamesOfPlacedLinesAreLimited) {
  const auto plan = [&](std::size_t length, int count) {
    const std::string blocks = "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nb\n" +
                               line(std::string(length, 'L'), 0, 0, 1, 0) +
                               "0\nENDBLK\n0\nENDSEC\n";
    return blocks +
           drawing(walls("WALL") + fmt::format("0\nINSERT\n2\nb\n70\n{}\n71\n{}\n", count, count));
  };
  EXPECT_TRUE(import(file("plan.dxf", plan(255, 10))));
  EXPECT_TRUE(import(file("plan.dxf", plan(30000, 3))));
  EXPECT_NE(refusal(plan(30000, 100)).find("more points than a plan"), std::string::npos);
}

TEST_F(Dxf, KindsOfOmittedEntitiesAreReportedAsUtf8) {
  const auto room = import(file("plan.dxf", drawing(walls("WALL") + "0\nT\xdcR\n8\nWALL\n")));
  ASSERT_TRUE(room) << room.error().message;
  EXPECT_NE(remarks(*room).find("1 T\xc3\x9cR"), std::string::npos) << remarks(*room);
}

// Each block holds the next one a hundred times.
TEST_F(Dxf, RefusesBlocksNestedTooDeeply) {
  std::string blocks = "0\nSECTION\n2\nBLOCKS\n";
  for (int i = 0; i < 15; ++i) {
    blocks += fmt::format("0\nBLOCK\n2\nb{}\n", i);
    for (int k = 0; k < 100; ++k) {
      blocks += fmt::format("0\nINSERT\n2\nb{}\n", i + 1);
    }
    blocks += "0\nENDBLK\n";
  }
  const std::string bomb = blocks + "0\nENDSEC\n" + drawing("0\nINSERT\n2\nb0\n");
  EXPECT_NE(refusal(bomb).find("more points than a plan of rooms"), std::string::npos);
}

TEST(WallLines, TwoFacesAreOneWallAndALineAloneIsOne) {
  // The faces of two walls that meet in a corner, and a single line.
  const std::vector<WallLine> drawn = {{{0, 0}, {4, 0}, "w", 0},
                                       {{0.1, 0.1}, {3.9, 0.1}, "w", 0},
                                       {{4, 0}, {4, 3}, "w", 0},
                                       {{3.9, 0.1}, {3.9, 3}, "w", 0},
                                       {{0, 2}, {2, 2}, "w", 0}};
  const std::vector<WallLine> walls = wall_lines(drawn);
  ASSERT_EQ(walls.size(), 3U);
  EXPECT_NEAR(walls[0].thickness, 0.1, 1e-12);
  EXPECT_NEAR(walls[0].from[1], 0.05, 1e-12);
  EXPECT_NEAR(walls[1].from[0], 3.95, 1e-12);
  EXPECT_EQ(walls[2].thickness, 0.0);
  EXPECT_NEAR(length_of(walls[2]), 2.0, 1e-12);
}

// The ends of a wall are as short as the chords of a narrow curve.
TEST(WallLines, ChordsOfACurveAreKeptAndEndsOfAWallAreNot) {
  std::vector<WallLine> curve;
  for (int i = 0; i < 8; ++i) {
    const auto at = [](int k) {
      return FloorPoint{2.0 * std::cos(0.2 * k), 2.0 * std::sin(0.2 * k)};
    };
    curve.push_back({at(i), at(i + 1), "w", 0});
  }
  EXPECT_EQ(wall_lines(curve).size(), 8U);
  const std::vector<WallLine> wall = {{{0, 0}, {4, 0}, "w", 0},
                                      {{4, 0}, {4, 0.3}, "w", 0},
                                      {{4, 0.3}, {0, 0.3}, "w", 0},
                                      {{0, 0.3}, {0, 0}, "w", 0}};
  EXPECT_EQ(wall_lines(wall).size(), 1U);
}

TEST(WallLines, AWindowCutsItsWall) {
  const std::vector<WallLine> walls = {{{0, 0}, {4, 0}, "w", 0.2}, {{0, 3}, {4, 3}, "w", 0.2}};
  const std::vector<WallLine> left = cut_at(walls, {{3, 0.05}, {1.5, 0.05}, "g", 0});
  ASSERT_EQ(left.size(), 3U);
  EXPECT_NEAR(left[0].to[0], 1.5, 1e-12);
  EXPECT_NEAR(left[1].from[0], 3.0, 1e-12);
  EXPECT_NEAR(length_of(left[2]), 4.0, 1e-12);
}

}  // namespace
}  // namespace rayloc::dxf_test
