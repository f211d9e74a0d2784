// The verbs print the notes on how a scene was read.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/rayloc_process.h"

namespace rayloc::field_scene_notes_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr const char* kScene = R"(<scene version="3.0.0">
<bsdf type="diffuse" id="mat-itu_concrete"><string name="type" value="glass"/></bsdf>
<shape type="cube" id="room"><transform name="to_world"><scale value="2 1.5 1.25"/><rotate z="2" angle="0"/><translate value="2 1.5 1.25"/></transform><ref id="mat-itu_concrete" name="bsdf"/></shape>
<shape type="rectangle" id="emit-Lamp"><emitter type="area"/><bsdf type="null"/></shape>
</scene>
)";
constexpr const char* kSite = R"(name = "cell"
scene = "scene.xml"
[carrier]
channel = 36
bandwidth_mhz = 40
centre_hz = 5190000000
tones = 128
tone_spacing_hz = 312500
active = [[-58, -2], [2, 58]]
[[access_point]]
id = "ap1"
format = "axcsi-v4"
position = [0.4, 0.4, 1.2]
yaw_deg = 45
pattern = "half_wave_dipole"
[[access_point.antenna]]
core = 0
offset = [0, 0, 0]
)";

class FieldSceneNotes : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("rayloc-scene-notes." + std::to_string(::getpid()));
    fs::create_directories(folder_);
    std::ofstream(folder_ / "scene.xml") << kScene;
    std::ofstream(folder_ / "site.toml") << kSite;
  }
  void TearDown() override { fs::remove_all(folder_); }

  void expect_notes(const std::string& words) const {
    EXPECT_THAT(words, HasSubstr("scene.xml:2:1: warning: material 'concrete': its id names"));
    EXPECT_THAT(words, HasSubstr("scene.xml:3:84: warning: the axis of this <rotate>"));
    EXPECT_THAT(words, HasSubstr("are left out: 'emit-Lamp' (a lamp)"));
  }

  fs::path folder_;
};

TEST_F(FieldSceneNotes, SceneCheckReportsThem) {
  const Finished checked = RaylocProcess({"scene", "check", folder_, "--json"}).wait();
  ASSERT_EQ(checked.status, 0) << checked.err;
  const auto json = nlohmann::json::parse(checked.out);
  std::vector<std::string> kinds;
  for (const auto& warning : json["warnings"]) {
    kinds.push_back(warning["kind"]);
  }
  EXPECT_THAT(kinds, ::testing::IsSupersetOf({"material", "rotation_axis", "left_out"}));
}

TEST_F(FieldSceneNotes, VerbsThatUseTheSceneReportThem) {
  const Finished traced =
      RaylocProcess({"trace", folder_, "--tx", "1,1,1", "--rx", "2,2,1"}).wait();
  ASSERT_EQ(traced.status, 0) << traced.err;
  expect_notes(traced.err);
  const Finished checked = RaylocProcess({"check-config", folder_}).wait();
  ASSERT_EQ(checked.status, 0) << checked.err;
  expect_notes(checked.err);
  std::ofstream(folder_ / "empty.pcap", std::ios::binary)
      << std::string("\xd4\xc3\xb2\xa1\x02\0\x04\0\0\0\0\0\0\0\0\0\xff\xff\0\0\x01\0\0\0", 24);
  expect_notes(
      RaylocProcess({"replay", folder_, "ap1=" + (folder_ / "empty.pcap").string(), "--no-cache"})
          .wait()
          .err);
}

TEST_F(FieldSceneNotes, MistakesOfASceneAreALineEach) {
  std::ofstream(folder_ / "scene.xml") << "<scene>\n<bsdf type=\"radio-material\" id=\"m\"><float "
                                          "name=\"sigma\" value=\"1\"/></bsdf>\n"
                                          "<shape type=\"cube\" id=\"c\"><transform "
                                          "name=\"toWorld\"/><ref id=\"m\"/></shape></scene>\n";
  const Finished checked = RaylocProcess({"scene", "check", folder_ / "scene.xml"}).wait();
  EXPECT_EQ(checked.status, 65);
  EXPECT_THAT(checked.err, HasSubstr("scene.xml:2:36: <float name=\"sigma\">"));
  EXPECT_THAT(checked.err, HasSubstr("\n" + (folder_ / "scene.xml:3:27: ").string()));
}

}  // namespace
}  // namespace rayloc::field_scene_notes_test
