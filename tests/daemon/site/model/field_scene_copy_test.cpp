// A copy of a site can be read, whatever its scene's names of files and its materials are.
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_copy.h"

namespace rayloc::field_scene_copy_test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFloor =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n4 0 0\n4 3 0\n3 0 1 2\n";

class FieldSceneCopy : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "site");
    fs::create_directories(folder_ / "meshes");
    std::ofstream(folder_ / "meshes" / "floor.PLY") << kFloor;
    fs::copy(folder_ / "meshes", folder_ / "site" / "meshes");
    std::ofstream(folder_ / "site" / "site.toml")
        << "name = \"s\"\nscene = \"scene.xml\"\n[carrier]\nchannel = 36\nbandwidth_mhz = 40\n"
           "centre_hz = 5190000000\ntones = 128\ntone_spacing_hz = 312500\n"
           "active = [[-58, -2], [2, 58]]\n"
           "[[access_point]]\nid = \"ap1\"\nformat = \"axcsi-v4\"\nposition = [1, 1, 1]\nyaw_deg = "
           "0\npattern = \"isotropic\"\n[[access_point.antenna]]\ncore = 0\noffset = [0, 0, 0]\n"
           "[materials.paint]\nrelative_permittivity = 2.5\nconductivity = 0.01\n";
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Reads the site with the mesh named so, copies it, and reads the copy alone.
  void expect_copy(const std::string& mesh) {
    std::ofstream(folder_ / "site" / "scene.xml")
        << "<scene><default name=\"id\" value=\"floor\"/><bsdf type='diffuse' id='mat-paint'/>"
           "<shape type='ply' id='$id'><string name='filename' value=" +
               mesh + "/><ref id='mat-paint'/></shape></scene>";
    const auto site = load_site(folder_ / "site");
    ASSERT_TRUE(site) << site.error().message;
    const auto room = load_room_model(*site);
    ASSERT_TRUE(room) << mesh << "\n" << room.error().message;
    const fs::path copy = folder_ / "copies" / "copy";
    fs::remove_all(copy);
    const auto written = write_site(*site, "", copy);
    ASSERT_TRUE(written) << mesh << "\n" << written.error().message;
    auto copied = load_site(copy);
    ASSERT_TRUE(copied) << copied.error().message;
    copied->calibration_file.reset();
    const auto read = load_room_model(*copied);
    ASSERT_TRUE(read) << mesh << "\n" << read.error().message;
    EXPECT_EQ(read->scene_hash, room->scene_hash);
  }

  fs::path folder_;
};

TEST_F(FieldSceneCopy, CopiesASceneWithWindowsPaths) {
  for (const char* mesh : {R"("meshes\floor.PLY")",
                           R"('.\meshes\floor.PLY')",
                           R"('..\meshes\floor.PLY')",
                           "'../meshes/floor.PLY'",
                           R"("../meshes/floor.PLY")"}) {
    expect_copy(mesh);
  }
}

TEST_F(FieldSceneCopy, RefusesAMeshNameWithAVariable) {
  std::ofstream(folder_ / "site" / "scene.xml")
      << "<scene><default name='up' value='..'/><bsdf type='diffuse' id='mat-paint'/>"
         "<shape type='ply' id='f'><string name='filename' value='$up/meshes/floor.PLY'/>"
         "<ref id='mat-paint'/></shape></scene>";
  const auto site = load_site(folder_ / "site");
  ASSERT_TRUE(site) << site.error().message;
  ASSERT_TRUE(load_room_model(*site));
  const auto written = write_site(*site, "", folder_ / "copy");
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("the mesh ../meshes/floor.PLY lies outside"),
            std::string::npos)
      << written.error().message;
}

}  // namespace
}  // namespace rayloc::field_scene_copy_test
