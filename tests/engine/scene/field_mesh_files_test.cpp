// Mesh files whose header does not fit their body, whose vertices lack a coordinate, and whose
// faces have several materials.
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/scene/read/load_scene.h"
#include "engine/scene/read/mesh_reader.h"

namespace rayloc::field_mesh_files_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

enum class Format { kAscii, kLittleEndian, kBigEndian };
constexpr std::array kFormats = {Format::kAscii, Format::kLittleEndian, Format::kBigEndian};

// The counts in the header of a PLY file; the body has 5 vertices, 3 faces and 2 edges.
struct Counts {
  int vertices = 5;
  int faces = 3;
  int edges = 2;
};

class Ply {
 public:
  Ply(Format format, Counts counts, bool edges = false) : format_(format) {
    const auto name = [&] {
      switch (format) {
        case Format::kAscii:
          return "ascii";
        case Format::kLittleEndian:
          return "binary_little_endian";
        case Format::kBigEndian:
          break;
      }
      return "binary_big_endian";
    };
    bytes_ = "ply\nformat " + std::string(name()) + " 1.0\nelement vertex " +
             std::to_string(counts.vertices) +
             "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
             std::to_string(counts.faces) + "\nproperty list uchar int vertex_indices\n";
    if (edges) {
      bytes_ += "element edge " + std::to_string(counts.edges) +
                "\nproperty int vertex1\nproperty int vertex2\n";
    }
    bytes_ += "end_header\n";
    for (const auto& [x, y] :
         {std::pair{0.F, 0.F}, {3.F, 0.F}, {3.F, 2.5F}, {0.F, 2.5F}, {4.F, 1.F}}) {
      add(x);
      add(0.25F);
      add(y);
      end_entry();
    }
    for (const auto& [a, b, c] : {std::array{0, 1, 2}, {0, 2, 3}, {1, 4, 2}}) {
      add(std::uint8_t{3});
      for (const std::int32_t corner : {a, b, c}) {
        add(corner);
      }
      end_entry();
    }
    for (const auto& [a, b] : {std::pair{0, 1}, {1, 4}}) {
      if (edges) {
        add(std::int32_t{a});
        add(std::int32_t{b});
        end_entry();
      }
    }
  }
  const std::string& bytes() const { return bytes_; }

 private:
  template <typename T>
  void add(T value) {
    if (format_ == Format::kAscii) {
      bytes_ += std::to_string(value) + " ";
      return;
    }
    std::string raw(sizeof(T), '\0');
    std::memcpy(raw.data(), &value, sizeof(T));
    if ((format_ == Format::kBigEndian) != (std::endian::native == std::endian::big)) {
      raw.assign(raw.rbegin(), raw.rend());
    }
    bytes_ += raw;
  }
  void end_entry() { bytes_ += format_ == Format::kAscii ? "\n" : ""; }

  Format format_;
  std::string bytes_;
};

struct Read {
  std::size_t triangles = 0;
  std::string error;
  std::vector<SceneNote> notes;
};

Read read(const std::string& bytes, const std::string& name = "wall.ply") {
  Read result;
  const auto mesh = read_mesh(bytes, name, result.notes);
  result.triangles = mesh ? mesh->triangles.size() : 0;
  result.error = mesh ? "" : mesh.error().message;
  return result;
}

void expect_note(const Read& read, const std::string& kind, const std::vector<std::string>& words) {
  EXPECT_THAT(read.error, IsEmpty());
  ASSERT_EQ(read.notes.size(), 1U);
  EXPECT_EQ(read.notes[0].kind, kind);
  for (const std::string& word : words) {
    EXPECT_THAT(read.notes[0].message, HasSubstr(word));
  }
}

TEST(Field, PlyHeaderThatCountsFewerFacesIsAWarningWithBothCounts) {
  for (const Format format : kFormats) {
    const Read less = read(Ply(format, {.faces = 1}).bytes());
    EXPECT_EQ(less.triangles, 1U);
    expect_note(less, "mesh_count", {"wall.ply:7:", "counts 1 of element 'face'", "holds 3"});
  }
}

TEST(Field, PlyHeaderThatCountsFewerVerticesIsAnErrorWithBothCounts) {
  // The faces would be read from the bytes of vertices.
  for (const Format format : kFormats) {
    for (const bool edges : {false, true}) {
      EXPECT_THAT(read(Ply(format, {.vertices = 4}, edges).bytes()).error,
                  AllOf(HasSubstr("wall.ply:3:"),
                        HasSubstr("counts 4 of element 'vertex'"),
                        HasSubstr("holds 5")));
    }
  }
}

TEST(Field, PlyHeaderThatCountsMoreThanTheFileHoldsIsAnErrorWithBothCounts) {
  for (const Format format : kFormats) {
    EXPECT_THAT(read(Ply(format, {.vertices = 6}).bytes()).error,
                AllOf(HasSubstr("counts 6 of element 'vertex'"), HasSubstr("holds 5")));
    EXPECT_THAT(read(Ply(format, {.faces = 4}).bytes()).error,
                AllOf(HasSubstr("counts 4 of element 'face'"), HasSubstr("holds 3")));
    EXPECT_THAT(read(Ply(format, {.edges = 3}, true).bytes()).error,
                AllOf(HasSubstr("counts 3 of element 'edge'"), HasSubstr("holds 2")));
  }
}

TEST(Field, PlyHeaderThatMiscountsAnotherElementNamesIt) {
  for (const Format format : kFormats) {
    const Read fewer_edges = read(Ply(format, {.edges = 1}, true).bytes());
    EXPECT_EQ(fewer_edges.triangles, 3U);
    expect_note(fewer_edges, "mesh_count", {"counts 1 of element 'edge'", "holds 2"});
    // Edges follow: their numbers would be read from those of a face.
    EXPECT_THAT(read(Ply(format, {.faces = 2}, true).bytes()).error,
                AllOf(HasSubstr("counts 2 of element 'face'"), HasSubstr("holds 3")));
  }
}

TEST(Field, DataAfterThePlyBodyIsAWarningAndBlanksAreNone) {
  for (const Format format : kFormats) {
    const std::string whole = Ply(format, {}).bytes();
    expect_note(read(whole + "made by scan"), "mesh_count", {"wall.ply:", "bytes follow"});
    for (const std::string& fill : {std::string(), std::string("\n\r\n"), std::string(512, '\0')}) {
      const Read good = read(whole + fill);
      EXPECT_THAT(good.error, IsEmpty());
      EXPECT_THAT(good.notes, IsEmpty());
      EXPECT_EQ(good.triangles, 3U);
    }
  }
}

TEST(Field, CountOfAPlyElementWithoutPropertiesCostsNoTime) {
  const std::string whole = Ply(Format::kAscii, {.faces = 1}).bytes();
  const std::string element = "element nothing 99999999999999\n";
  for (const char* before : {"element vertex", "element face", "end_header"}) {
    std::string bytes = whole;
    EXPECT_THAT(read(bytes.insert(bytes.find(before), element)).error, HasSubstr("wall.ply:"));
  }
}

TEST(Field, PlyTextWithEntriesOverSeveralLinesStaysReadable) {
  const Read good = read(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0 1 0\n0 1 1 "
      "0\n3\n0 "
      "1 2\n");
  EXPECT_THAT(good.error, IsEmpty());
  EXPECT_THAT(good.notes, IsEmpty());
  EXPECT_EQ(good.triangles, 1U);
}

std::string with_properties(const std::string& vertex, const std::string& face) {
  return "ply\nformat ascii 1.0\nelement vertex 3\n" + vertex + "element face 1\n" + face +
         "end_header\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n";
}

TEST(Field, PlyVerticesWithoutACoordinateAreRefusedWithTheirProperties) {
  const std::string list = "property list uchar int vertex_indices\n";
  EXPECT_THAT(
      read(with_properties("property float x\nproperty float y\nproperty float height\n", list))
          .error,
      AllOf(HasSubstr("wall.ply:3:"), HasSubstr("no property z"), HasSubstr("x, y, height")));
  EXPECT_THAT(
      read(with_properties("property float X\nproperty float Y\nproperty float Z\n", list)).error,
      AllOf(HasSubstr("no property x"), HasSubstr("X, Y, Z")));
  EXPECT_THAT(
      read(with_properties("property float x\nproperty float z\nproperty float w\n", list)).error,
      AllOf(HasSubstr("no property y"), HasSubstr("x, z, w")));
  EXPECT_THAT(read(with_properties(
                       "property float x\nproperty float y\nproperty list uchar float z\n", list))
                  .error,
              AllOf(HasSubstr("no property z"), HasSubstr("list z")));
}

TEST(Field, PlyFacesWithoutTheirListAreRefusedWithTheirProperties) {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  EXPECT_THAT(read(with_properties(xyz, "property list uchar int corners\n")).error,
              AllOf(HasSubstr("wall.ply:7:"),
                    HasSubstr("no list vertex_indices"),
                    HasSubstr("list corners")));
  EXPECT_THAT(read(with_properties(xyz, "property int vertex_indices\n")).error,
              HasSubstr("no list vertex_indices"));
  EXPECT_THAT(read(with_properties(xyz, "property list float int vertex_indices\n")).error,
              AllOf(HasSubstr("wall.ply:8:"), HasSubstr("length"), HasSubstr("whole number")));
  EXPECT_THAT(read(with_properties("property half x\n", "")).error,
              AllOf(HasSubstr("wall.ply:4:"), HasSubstr("'half'")));
  // Other names and types that exporters write.
  const Read good =
      read(with_properties("property double z\nproperty short x\nproperty float32 y\n",
                           "property list uint uint vertex_index\n"));
  EXPECT_THAT(good.error, IsEmpty());
  EXPECT_EQ(good.triangles, 1U);
}

constexpr const char* kVertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Field, ObjFacesOfSeveralMaterialsAreAWarningThatNamesThem) {
  const std::string vertices = kVertices;
  const Read two =
      read(vertices + "usemtl glass\nf 1 2 3\nusemtl Concrete.001\nf 1 3 4\n", "room.obj");
  EXPECT_EQ(two.triangles, 2U);
  expect_note(two, "mesh_materials", {"room.obj", "'glass'", "'Concrete.001'", "separate"});
  expect_note(read(vertices + "f 1 2 3\nusemtl glass\nf 1 3 4\n", "room.obj"),
              "mesh_materials",
              {"no material", "'glass'"});
  expect_note(
      read(vertices + "usemtl Dark Oak\nf 1 2 3\nusemtl Dark Glass \nf 1 3 4\n", "room.obj"),
      "mesh_materials",
      {"'Dark Oak'", "'Dark Glass'"});
  // One material of all faces, however often it is named, and one that no face has.
  const std::string one = "usemtl glass\nf 1 2 3\nusemtl oak\nusemtl glass\nf 1 3 4\n";
  EXPECT_THAT(read(vertices + one, "room.obj").notes, IsEmpty());
}

TEST(Field, PlyFacesOfSeveralMaterialsAreAWarning) {
  const auto ply = [](const std::string& property,
                      const std::string& first,
                      const std::string& second) {
    return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
           "float z\nelement face 2\nproperty list uchar int vertex_indices\nproperty uchar " +
           property + "\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 " + first + "\n3 0 2 3 " +
           second + "\n";
  };
  for (const char* property : {"material_index", "material_id", "MaterialID", "mat_id"}) {
    expect_note(
        read(ply(property, "0", "4")), "mesh_materials", {"wall.ply", property, "separate"});
    EXPECT_THAT(read(ply(property, "4", "4")).notes, IsEmpty());
  }
  EXPECT_THAT(read(ply("red", "0", "4")).notes, IsEmpty());
}

TEST(Field, NotesOfAMeshFileNameItsShape) {
  const std::string xml =
      "<scene version=\"3.0.0\">\n<bsdf type=\"itu-radio-material\" id=\"mat-wall\"><string "
      "name=\"type\" value=\"glass\"/></bsdf>\n<shape type=\"ply\" id=\"mesh-north\"><string "
      "name=\"filename\" value=\"wall.ply\"/><ref id=\"mat-wall\"/></shape>\n</scene>\n";
  const auto scene = parse_scene(xml, "scene.xml", SceneOptions{5e9, {}}, [](const std::string&) {
    return Ply(Format::kAscii, {.faces = 2}).bytes();
  });
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->notes().size(), 1U);
  EXPECT_THAT(
      to_line(scene->notes()[0]),
      AllOf(HasSubstr("scene.xml:3:1: warning: "), HasSubstr("'north'"), HasSubstr("wall.ply")));
}

std::string error_of(const std::string& shapes) {
  const auto scene = parse_scene(
      "<scene version=\"3.0.0\">\n<bsdf type=\"itu-radio-material\" id=\"mat-wall\"><string "
      "name=\"type\" value=\"glass\"/></bsdf>\n<bsdf type=\"itu-radio-material\" "
      "id=\"mat-chair\"><string name=\"type\" value=\"wood\"/></bsdf>\n" +
          shapes + "</scene>\n",
      "scene.xml",
      SceneOptions{5e9, {}},
      [](const std::string&) { return Ply(Format::kAscii, {}).bytes(); });
  return scene ? "" : scene.error().message;
}

TEST(Field, InstancesAreOneErrorForTheFile) {
  const std::string wall =
      "<shape type=\"rectangle\" id=\"floor\"><ref id=\"mat-wall\"/></shape>\n";
  const std::string group =
      "<shape type=\"shapegroup\" id=\"chairs\"><shape type=\"ply\"><string name=\"filename\" "
      "value=\"chair.ply\"/><ref id=\"mat-wall\"/></shape></shape>\n";
  const std::string copy =
      "<shape type=\"instance\"><ref id=\"chairs\"/><transform name=\"to_world\"><translate "
      "x=\"1\"/></transform></shape>\n";
  for (const auto& shapes : std::vector<std::vector<std::string>>{
           {wall, group, copy, copy}, {group, copy}, {copy, group, wall}, {wall, copy}}) {
    const std::string error =
        error_of(std::accumulate(shapes.begin(), shapes.end(), std::string()));
    EXPECT_THAT(error,
                AllOf(HasSubstr("scene.xml:"), HasSubstr("instances"), HasSubstr("Blender")));
    EXPECT_THAT(error, Not(HasSubstr("\n")));
  }
  EXPECT_THAT(error_of("<shape type=\"merge\"><shape type=\"cube\"/></shape>\n"),
              AllOf(HasSubstr("'merge'"), HasSubstr("<scene>"), Not(HasSubstr("\n"))));
  // Mistakes that have nothing to do with them are named as well.
  EXPECT_THAT(
      error_of(group + copy + "<shape type=\"cube\" id=\"box\"><ref id=\"mat-wal\"/></shape>\n"),
      AllOf(HasSubstr("instances"), HasSubstr("'mat-wal'")));
  EXPECT_THAT(error_of(wall), IsEmpty());
}

TEST(Field, ShapeOfSeveralMaterialsIsAnErrorThatNamesThem) {
  EXPECT_THAT(
      error_of("<shape type=\"cube\" id=\"box\"><ref id=\"mat-wall\"/><ref "
               "id=\"mat-chair\"/></shape>\n"),
      AllOf(HasSubstr("scene.xml:4:"), HasSubstr("mat-wall, mat-chair"), HasSubstr("Blender")));
}

}  // namespace
}  // namespace rayloc::field_mesh_files_test
