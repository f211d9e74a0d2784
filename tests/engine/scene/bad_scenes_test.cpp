// Scenes that cannot be used: each is refused, and the message names the place and the fault.
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "engine/scene/read/load_scene.h"
#include "tests/support/scenes.h"

namespace rayloc::bad_scenes_test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlyHeader =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

std::string scene_xml(const std::string& mesh_file, const std::string& transform = "") {
  return "<scene version='2.1.0'>\n<bsdf type='diffuse' id='mat-itu_concrete'/>\n"
         "<shape type='" +
         mesh_file.substr(mesh_file.size() - 3) +
         "' id='mesh-floor'><string name='filename' value='" + mesh_file +
         "'/><transform name='to_world'>" + transform +
         "</transform><ref id='mat-itu_concrete' name='bsdf'/></shape>\n</scene>\n";
}

// The error of a scene of that one mesh.
std::string error_of(const std::string& mesh_file,
                     const std::string& mesh,
                     const std::string& transform = "") {
  const auto scene = parse_scene(scene_xml(mesh_file, transform),
                                 "scene.xml",
                                 {test::kCarrier, {}},
                                 [&](const std::string&) -> Expected<std::string> { return mesh; });
  return scene ? "(no error)" : scene.error().message;
}

TEST(BadScenes, VertexThatIsNoNumberIsNamedWithItsLine) {
  for (const char* value : {"nan", "inf", "-inf"}) {
    EXPECT_EQ(error_of("floor.ply",
                       std::string(kPlyHeader) + "0 0 0\n1 " + value + " 0\n0 1 0\n3 0 1 2\n"),
              "scene.xml:3:1: shape 'floor': floor.ply:11: vertex 1 has a coordinate that is not a "
              "finite number");
  }
}

TEST(BadScenes, VertexThatIsNoNumberIsNamedInABinaryMesh) {
  std::string mesh = kPlyHeader;
  mesh.replace(mesh.find("ascii"), 5, "binary_little_endian");
  for (const float value : {0.0F, 0.0F, std::numeric_limits<float>::quiet_NaN()}) {
    std::string bytes(sizeof(value), '\0');
    std::memcpy(bytes.data(), &value, sizeof(value));
    mesh += bytes;
  }
  mesh += std::string(2 * 12 + 13, '\0');
  EXPECT_NE(error_of("floor.ply", mesh).find("vertex 0 has a coordinate that is not a finite"),
            std::string::npos)
      << error_of("floor.ply", mesh);
}

TEST(BadScenes, VertexOfAnObjFileThatIsNoNumberIsRefused) {
  EXPECT_EQ(error_of("floor.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n"),
            "scene.xml:3:1: shape 'floor': floor.obj:2: a coordinate of vertex 2 is not a finite "
            "number");
}

TEST(BadScenes, TransformThatLosesTheMeshIsRefused) {
  const std::string mesh = std::string(kPlyHeader) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_EQ(error_of("floor.ply", mesh, "<scale value='1e300'/>"),
            "scene.xml: object 'floor': vertex 1 is further than 100 km from the origin");
  EXPECT_EQ(error_of("floor.ply", mesh, "<scale x='1' y='0' z='1'/>"),
            "scene.xml: object 'floor' has no triangle that is at least a micrometre high");
}

TEST(BadScenes, UnknownMaterialIsNamedWithItsPlaceAndTheClosest) {
  const auto scene = parse_scene(
      "<scene>\n<bsdf type='diffuse' id='mat-itu_plasterbord'/>\n"
      "<shape type='cube'><ref id='mat-itu_plasterbord' name='bsdf'/></shape></scene>",
      "scene.xml",
      {test::kCarrier, {}},
      nullptr);
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("scene.xml:2:1: material 'plasterbord'"), std::string::npos)
      << scene.error().message;
  EXPECT_NE(scene.error().message.find("did you mean 'plasterboard'"), std::string::npos)
      << scene.error().message;
}

TEST(BadScenes, FrequencyThatIsNoneIsRefused) {
  const std::string xml =
      "<scene><bsdf type='radio-material' id='m'/>"
      "<shape type='cube'><ref id='m' name='bsdf'/></shape></scene>";
  for (const double hertz : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    const auto scene = parse_scene(xml, "scene.xml", {hertz, {}}, nullptr);
    ASSERT_FALSE(scene) << hertz;
    EXPECT_EQ(scene.error().message, "scene.xml: the carrier frequency must be more than 0 Hz");
  }
}

TEST(BadScenes, NumbersOfOnesOwnHelpOutsideOfTheItuRange) {
  const std::string xml =
      "<scene><bsdf type='diffuse' id='mat-itu_concrete'/>"
      "<shape type='cube'><ref id='mat-itu_concrete' name='bsdf'/></shape></scene>";
  EXPECT_FALSE(parse_scene(xml, "scene.xml", {200e9, {}}, nullptr));
  const auto scene =
      parse_scene(xml, "scene.xml", {200e9, {{"concrete", {5.0, 2.0, std::nullopt}}}}, nullptr);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->materials()[0].conductivity, 2.0);
}

// As files on a disk.
class BadSceneFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("rayloc-bad-scenes." + std::to_string(::getpid()));
    fs::create_directories(folder_ / "meshes");
    std::ofstream(folder_ / "scene.xml") << scene_xml("meshes/floor.ply");
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string error() const {
    const auto scene = load_scene(folder_ / "scene.xml", {test::kCarrier, {}});
    return scene ? "(no error)" : scene.error().message;
  }

  fs::path folder_;
};

TEST_F(BadSceneFiles, MissingMeshIsNamedWithTheShapeThatWantsIt) {
  EXPECT_EQ(error(),
            folder_.string() + "/scene.xml:3:1: shape 'floor': " + folder_.string() +
                "/meshes/floor.ply does not exist");
}

TEST_F(BadSceneFiles, FolderIsNoMesh) {
  fs::create_directories(folder_ / "meshes" / "floor.ply");
  EXPECT_EQ(error(),
            folder_.string() + "/scene.xml:3:1: shape 'floor': " + folder_.string() +
                "/meshes/floor.ply is not a file");
}

TEST_F(BadSceneFiles, EmptyMeshIsNoPly) {
  std::ofstream(folder_ / "meshes" / "floor.ply") << "";
  EXPECT_NE(error().find("shape 'floor': meshes/floor.ply:0: the header has no end_header"),
            std::string::npos)
      << error();
}

}  // namespace
}  // namespace rayloc::bad_scenes_test
