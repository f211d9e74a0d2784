// Files of other programs, and what is no such file.
#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include "daemon/site/import/import_scene.h"
#include "daemon/site/import/recognise.h"
#include "tests/daemon/site/import/import_files.h"

namespace rayloc::import_test {
namespace {

namespace fs = std::filesystem;

// A room of 4 x 3 x 2.5 m with y up, floor, ceiling and a window, in metres.
constexpr const char* kRoom = R"(o floor
usemtl Beton
v 0 0 0
v 4 0 0
v 4 0 -3
v 0 0 -3
f 1 2 3 4
o ceiling
v 0 2.5 0
v 4 2.5 0
v 4 2.5 -3
v 0 2.5 -3
usemtl Decke
f 8 7 6 5
o Fenster.001
usemtl Material
f 1 2 6 5
o south
usemtl lacquer
f 4 3 7 8
)";

class Import : public test::ImportFiles {};
class Field : public test::ImportFiles {};

void expect_room(const ImportedScene& room) {
  EXPECT_NEAR(room.bounds.size().x, 4.0, 1e-5);
  EXPECT_NEAR(room.bounds.size().y, 3.0, 1e-5);
  EXPECT_NEAR(room.bounds.size().z, 2.5, 1e-5);
  std::vector<std::string> found;
  for (const StatedObject& object : room.scene.objects) {
    found.push_back(object.name.substr(0, 5) + "/" + object.material);
  }
  EXPECT_EQ(found,
            (std::vector<std::string>{
                "floor/concrete", "ceili/ceiling_board", "Fenst/glass", "south/plasterboard"}));
}

TEST_F(Import, ObjIsReadWithNamesMaterialsAndAxes) {
  const auto room = import(file("room.obj", kRoom));
  ASSERT_TRUE(room) << room.error().message;
  expect_room(*room);
  const std::string text = remarks(*room);
  EXPECT_NE(text.find("OBJ\nmetres, by the height of rooms"), std::string::npos) << text;
  EXPECT_NE(text.find("y is up, by 'floor'"), std::string::npos) << text;
  EXPECT_NE(text.find("no row of the table of materials is of south"), std::string::npos) << text;
}

TEST(ImportedNames, ANumberedNameThatIsTakenIsSkipped) {
  Model model;
  for (const char* name : {"desk", "desk_2", "desk", "desk", "desk_2"}) {
    model.parts.push_back({name, "", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}});
  }
  const auto scene = scene_of(model, *MaterialTable::parse(kDefaultMaterialTable, "materials"), {});
  ASSERT_TRUE(scene) << scene.error().message;
  std::vector<std::string> names;
  for (const StatedObject& object : scene->scene.objects) {
    names.push_back(object.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"desk", "desk_2", "desk_3", "desk_4", "desk_2_2"}));
}

TEST_F(Import, AcceptsAStatedUnitAndAxis) {
  const auto room = import(file("room.obj", kRoom), {{0.3048, 'z'}, 0.0});
  ASSERT_TRUE(room) << room.error().message;
  EXPECT_NEAR(room->bounds.size().y, 2.5 * 0.3048, 1e-5);
}

TEST_F(Import, MillimetresAreRecognised) {
  std::string large = kRoom;
  for (std::size_t at = 0; (at = large.find("2.5", at)) != std::string::npos;) {
    large.replace(at, 3, "2500");
  }
  for (const auto& [from, to] : {std::pair{"v 4", "v 4000"}, {" -3\n", " -3000\n"}}) {
    for (std::size_t at = 0; (at = large.find(from, at)) != std::string::npos;) {
      large.replace(at, std::string(from).size(), to);
      at += std::string(to).size();
    }
  }
  const auto room = import(file("room.obj", large));
  ASSERT_TRUE(room) << room.error().message;
  EXPECT_NEAR(room->bounds.size().x, 4.0, 1e-5);
  EXPECT_NE(remarks(*room).find("millimetres"), std::string::npos);
}

// A storey drawn in centimetres is read as 12 m, not as 1.2 m; a wrong stated unit is refused.
TEST_F(Import, UnitsAreThoseInWhichRoomsAreAsHighAsRooms) {
  const std::string storey =
      "o walls\nv 0 0 0\nv 1200 0 0\nv 1200 250 0\nv 0 250 0\nv 0 0 -800\nf 1 2 3 4\nf 1 2 5\n";
  const auto room = import(file("storey.obj", storey));
  ASSERT_TRUE(room) << room.error().message;
  EXPECT_NEAR(room->bounds.size().x, 12.0, 1e-5);
  EXPECT_NE(remarks(*room).find("centimetres, by the height of rooms"), std::string::npos);
  const auto large = import(file("storey.obj", storey), {{1.0, 'y'}, 0.0});
  ASSERT_FALSE(large);
  EXPECT_NE(large.error().message.find("would be 1200 m long"), std::string::npos);
}

// assimp's own program writes the other formats.
TEST_F(Import, FilesOfAnotherProgramAreTheSameRoom) {
  if (std::system("command -v assimp > /dev/null") != 0) {
    GTEST_SKIP() << "assimp (Debian: assimp-utils) is not installed";
  }
  const fs::path room = file("room.obj", kRoom);
  for (const char* name : {"room.glb", "room.gltf"}) {
    const fs::path made = folder_ / name;
    const std::string format = std::string(name) == "room.glb" ? "glb2" : "gltf2";
    ASSERT_EQ(std::system(("assimp export " + room.string() + " " + made.string() + " -f" + format +
                           " > /dev/null")
                              .c_str()),
              0);
    const auto imported = import(made);
    ASSERT_TRUE(imported) << imported.error().message;
    expect_room(*imported);
    EXPECT_NE(remarks(*imported).find("y is up, as glTF states"), std::string::npos);
  }
}

// A model may come from an untrusted source and name any file.
TEST_F(Import, OnlyFilesBesideTheModelAreOpened) {
  const auto triangle = [](const std::string& buffer) {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":")" +
           buffer + "\"}]}";
  };
  const std::array<float, 9> corners = {0, 0, 0, 4, 0, 0, 0, 2.5F, 3};
  std::string bytes(sizeof corners, '\0');
  std::memcpy(bytes.data(), corners.data(), bytes.size());
  file("above.bin", bytes);
  fs::create_directories(folder_ / "models");
  file("models/corners.bin", bytes);
  EXPECT_TRUE(import(file("models/beside.gltf", triangle("corners.bin"))));
  EXPECT_FALSE(import(file("models/above.gltf", triangle("../above.bin"))));
  fs::create_symlink(folder_ / "above.bin", folder_ / "models/link.bin");
  EXPECT_FALSE(import(file("models/link.gltf", triangle("link.bin"))));
}

// The begin of a ZIP archive whose first file has that name.
std::string archive(const std::string& name) {
  std::string bytes("PK\x03\x04", 4);
  bytes.resize(26, '\0');
  bytes += static_cast<char>(name.size());
  bytes.append(3, '\0');
  return bytes + name + "content";
}

TEST_F(Import, RefusesInvalidModelsWithARemedy) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"AC1032 and so on", "a DWG drawing; export its plan as DXF or SVG"},
      {"ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));",
       "a STEP model; export it as GLB, OBJ or IFC, or its plan as DXF or SVG"},
      {"%PDF-1.7", "a PDF; open it in Inkscape"},
      {"PXR-USDC", "a USD scene; export"},
      {std::string("PK\x03\x04", 4), "an archive (ZIP); unpack it"},
      {archive("0/scan.usdc"), "a USDZ scan; export it as GLB or OBJ, of RoomPlan as JSON"},
      {archive("Home"), "a home of Sweet Home 3D; export it as OBJ"},
      {archive("Document.xml"), "a document of FreeCAD; export"},
      {archive("office.ifc"), "an archive (ZIP); unpack it"},
      {"\x89PNG\r\n", "a picture; lay it under a drawing in rayloc studio"},
      {std::string("II*\0\x08", 5), "a picture (TIFF); lay it"},
      {std::string("\0\0\0\x18"
                   "ftypheic",
                   12),
       "a picture or film of a phone; lay it"},
      {"LASF", "a cloud of points (LAS); make a mesh of it"},
      {std::string(80, ' ') + std::string("\1\0\0\0", 4) + std::string(50, '\0'),
       "an STL model, which has neither names nor units; export"},
      {"<?xml version=\"1.0\"?>\n<COLLADA version=\"1.4.1\">", "a COLLADA model; export it as GLB"},
      {"<?xml version=\"1.0\"?>\n<scene/>", "XML, but no SVG; a scene of Mitsuba needs no import"},
      {"\n<!DOCTYPE HTML>\n<body><svg/></body>", "a web page and no drawing; download the file"},
      {"name = \"office\"\nsize = [5, 3, 2.7]\n",
       "a plan of a room; make a scene of it with rayloc"},
      {"", "is empty"},
      {"hello, world", "of no format that can be imported; there are:"},
      {"{\"a\": 1}", "is JSON, but neither glTF, which has \"asset\", nor the scan of a room"},
      {"v 0 0 0\nv 1 0 0\n", "(OBJ); a cloud of points"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
       "float z\nend_header\n0 0 0\n",
       "(PLY); a cloud of points"},
      {"glTF garbage", "cannot be read as GLB"},
  };
  for (const auto& [content, message] : cases) {
    const std::string error = refusal("file", content);
    EXPECT_NE(error.find(message), std::string::npos) << content << ": " << error;
  }
}

std::string wall_as_ply(const std::string& third, int faces) {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
         "float " +
         third + "\nelement face " + std::to_string(faces) +
         "\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n4 0 0\n4 0 2.5\n0 0 2.5\n3 "
         "0 1 2\n3 0 2 3\n";
}

TEST_F(Field, PlyWithoutAHeightOrWithWrongCountsIsNamed) {
  EXPECT_NE(refusal("flat.ply", wall_as_ply("height", 2)).find("no property z"), std::string::npos);
  EXPECT_NE(refusal("more.ply", wall_as_ply("z", 3)).find("counts 3 of element 'face'"),
            std::string::npos);
  const auto less = import(file("less.ply", wall_as_ply("z", 1)));
  ASSERT_TRUE(less) << less.error().message;
  EXPECT_NE(remarks(*less).find("counts 1 of element 'face', the file holds 2"), std::string::npos);
  const auto right = import(file("right.ply", wall_as_ply("z", 2)));
  ASSERT_TRUE(right) << right.error().message;
  EXPECT_EQ(remarks(*right).find("counts"), std::string::npos);
}

TEST_F(Import, FilesOfTwoGigabytesAreRefusedUnread) {
  const fs::path large = file("large.obj", kRoom);
  fs::resize_file(large, std::uintmax_t{2} << 30U);  // a sparse file
  const auto imported = import(large);
  ASSERT_FALSE(imported);
  EXPECT_NE(imported.error().message.find("has 2048 MiB, more than the 256 MiB"),
            std::string::npos);
}

TEST(MaterialTable, MistakesHaveTheirPlace) {
  const auto table = MaterialTable::parse(
      "[[material]]\nmatch = [\"glass\"]\nitu = \"glas\"\n[[material]]\nwords = 3\n", "table.toml");
  ASSERT_FALSE(table);
  EXPECT_NE(table.error().message.find("table.toml:3:7: 'itu'"), std::string::npos)
      << table.error().message;
  EXPECT_NE(table.error().message.find("unknown key 'words'"), std::string::npos);
}

TEST(MaterialTable, TheNameOfTheMaterialCountsBeforeThatOfTheObject) {
  const auto table = MaterialTable::parse(kDefaultMaterialTable, "materials");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ(table->find("Oak veneer", "window")->itu, "wood");
  EXPECT_EQ(table->find("Material.001", "IfcWindow")->itu, "glass");
  EXPECT_FALSE(table->find("Material.001", "blob"));
  EXPECT_FALSE(table->find("", "bedroom wall"));
  EXPECT_EQ(table->find("", "Double_Bed.002")->itu, "wood");
  EXPECT_EQ(table->find("", "oakDoors2")->itu, "wood");
  EXPECT_EQ(table->find("Stahlbeton C30/37", "")->itu, "concrete");
  EXPECT_EQ(table->find("Gipskartonplatte", "")->itu, "plasterboard");
  EXPECT_FALSE(MaterialTable::parse("[[material]]\nmatch = [\" \"]\nitu = \"glass\"\n", "t"));
  EXPECT_EQ(table->otherwise("wall").itu, "plasterboard");
}

TEST(MaterialTable, LayersHaveNamesOfAnyLanguageAndCase) {
  const auto table = MaterialTable::parse(kDefaultMaterialTable, "materials");
  ASSERT_TRUE(table) << table.error().message;
  for (const auto& [name, kind] : {std::pair{"WÄNDE", "wall"},
                                   {"A-Wände", "wall"},
                                   {"eg_TÜREN", "door"},
                                   {"Fenêtres", "window"},
                                   {"MÖBEL", "furniture"},
                                   {"paredes", "wall"},
                                   {"0", ""}}) {
    EXPECT_EQ(table->layer(name), kind) << name;
  }
}

// The layer of a drawing without layers is "0".
TEST(MaterialTable, NamesWithoutALetterAreWrittenWhole) {
  const auto table = MaterialTable::parse(
      "[layers]\nwindow = [\"1-2\"]\ndoor = [\"3*\"]\nwall = [\"0\"]\n", "materials");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ(table->layer("0"), "wall");
  EXPECT_EQ(table->layer("1-2"), "window");
  EXPECT_EQ(table->layer("34"), "door");
  for (const char* other : {"00", "1", "2", "1-20", "x0", ""}) {
    EXPECT_EQ(table->layer(other), "") << other;
  }
  const auto all = MaterialTable::parse("[layers]\nwall = [\"*\"]\n", "materials");
  ASSERT_TRUE(all) << all.error().message;
  EXPECT_EQ(all->layer("0"), "wall");
  EXPECT_EQ(all->layer("Level 1"), "wall");
}

}  // namespace
}  // namespace rayloc::import_test
