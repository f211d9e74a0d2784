// `rayloc scene room` and `rayloc scene check` as processes of their own.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"

namespace rayloc::scene_test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlan = R"(name = "office"
size = [5.2, 3.4, 2.7]
floor = "concrete"
ceiling = "ceiling_board"
walls = "plasterboard"
[[box]]
name = "table"
material = "wood"
centre = [2.0, 1.5, 0.73]
size = [1.8, 0.9, 0.05]
)";
constexpr const char* kAccessPoint = R"([[access_point]]
id = "ap1"
position = [0.3, 0.3, 2.2]
[[access_point.antenna]]
core = 0
offset = [0, 0, 0]
)";

class SceneVerb : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("rayloc-scene-test." + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  static std::string content(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }
  Finished make_room(const std::string& plan) const {
    return RaylocProcess({"scene", "room", file("office.toml", plan), "--out", out()}).wait();
  }
  std::string out() const { return folder_ / "office"; }

  fs::path folder_;
};

TEST_F(SceneVerb, ImportOfADrawingOnPaperAsksForItsScale) {
  const std::string plan =
      file("plan.svg",
           "<svg width=\"160mm\" height=\"120mm\" viewBox=\"0 0 160 120\"><rect id=\"walls\" "
           "width=\"120\" height=\"80\"/></svg>");
  const auto import = [&](const std::vector<std::string>& options) {
    std::vector<std::string> words = {"scene", "import", plan, "--out", out()};
    words.insert(words.end(), options.begin(), options.end());
    return RaylocProcess(words).wait();
  };
  const Finished unscaled = import({});
  EXPECT_EQ(unscaled.status, 65);
  EXPECT_NE(unscaled.err.find("is 120 mm large on paper"), std::string::npos) << unscaled.err;
  EXPECT_FALSE(fs::exists(out())) << "nothing is written of what is refused";
  EXPECT_EQ(import({"--scale", "50", "--unit", "cm"}).status, 64);
  EXPECT_EQ(import({"--scale", "0"}).status, 64);
  const Finished made = import({"--scale", "50", "--access-point", "RT-AX86U"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_NE(made.err.find("6.00 x 4.00 x 2.70 m"), std::string::npos) << made.err;
  const Finished checked = RaylocProcess({"scene", "check", out()}).wait();
  EXPECT_EQ(checked.status, 0) << checked.err;
}

// Two closed lines 12 cm apart, in millimetres: the walls of 6 x 4 m.
std::string dxf_office() {
  std::string text =
      "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
  for (const int face : {0, 120}) {
    text += "0\nLWPOLYLINE\n8\nWALLS\n90\n4\n70\n1\n";
    for (const auto& [x, y] : {std::pair{-face, -face},
                               {6000 + face, -face},
                               {6000 + face, 4000 + face},
                               {-face, 4000 + face}}) {
      text += "10\n" + std::to_string(x) + "\n20\n" + std::to_string(y) + "\n";
    }
  }
  return text + "0\nENDSEC\n0\nEOF\n";
}

TEST_F(SceneVerb, ImportedOfficesPassTheCheck) {
  const std::vector<std::pair<std::string, std::string>> offices = {
      {file("office.dxf", dxf_office()), " x 2.70 m"},
      {test::data_path("/scenes/office.ifc"), "9 objects of 5 materials, 5.24 x 4.24 x 3.00 m"},
      {test::data_path("/scenes/office4.ifc"), "9 objects of 5 materials, 5.24 x 4.24 x 3.00 m"}};
  for (const auto& [office, size] : offices) {
    const Finished made =
        RaylocProcess(
            {"scene", "import", office, "--out", out(), "--force", "--access-point", "RT-AX86U"})
            .wait();
    ASSERT_EQ(made.status, 0) << made.err;
    EXPECT_NE(made.err.find(size), std::string::npos) << made.err;
    const Finished checked = RaylocProcess({"scene", "check", out()}).wait();
    EXPECT_EQ(checked.status, 0) << checked.err;
  }
}

TEST_F(SceneVerb, ImportTakesTheLayersOfWallsByName) {
  std::string plan = dxf_office();
  for (std::size_t at = 0; (at = plan.find("WALLS", at)) != std::string::npos;) {
    plan.replace(at, 5, "0");
  }
  const std::string drawing = file("office.dxf", plan);
  EXPECT_EQ(RaylocProcess({"scene", "import", drawing, "--out", out()}).wait().status, 65);
  const Finished made =
      RaylocProcess({"scene", "import", drawing, "--walls", "0", "--out", out()}).wait();
  EXPECT_EQ(made.status, 0) << made.err;
  EXPECT_NE(made.err.find(" x 2.70 m"), std::string::npos) << made.err;
  // The option takes one value, so that FILE may be next; several layers are several options.
  const Finished before =
      RaylocProcess({"scene", "import", "--walls", "0", drawing, "--force", "--out", out()}).wait();
  EXPECT_EQ(before.status, 0) << before.err;
  const Finished several = RaylocProcess({"scene",
                                          "import",
                                          "--walls",
                                          "0",
                                          "--walls",
                                          "[0,1]",
                                          drawing,
                                          "--force",
                                          "--out",
                                          out()})
                               .wait();
  EXPECT_EQ(several.status, 65);
  EXPECT_NE(several.err.find("'[0,1]'"), std::string::npos) << several.err;
  const Finished no_file =
      RaylocProcess({"scene", "import", "--walls", "0", "--out", out()}).wait();
  EXPECT_EQ(no_file.status, 64);
  EXPECT_NE(no_file.err.find("FILE"), std::string::npos) << no_file.err;
}

TEST_F(SceneVerb, RoomWithAnAccessPointOfAKnownModelIsASite) {
  const std::string plan = file("office.toml", kPlan);
  const Finished made =
      RaylocProcess({"scene", "room", plan, "--out", out(), "--access-point", "RT-AC86U"}).wait();
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_NE(made.err.find("a site; state the position of the access point in its site.toml"),
            std::string::npos)
      << made.err;
  const Finished checked = RaylocProcess({"scene", "check", out()}).wait();
  EXPECT_EQ(checked.status, 0) << checked.err;
  const Finished other =
      RaylocProcess({"scene", "room", plan, "--out", out(), "--access-point", "X"}).wait();
  EXPECT_EQ(other.status, 64);
  EXPECT_NE(other.err.find("RT-AX86U,RT-AC86U"), std::string::npos) << other.err;
}

TEST_F(SceneVerb, RoomIsASceneThatCheckReads) {
  const Finished made = make_room(kPlan);
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(made.out, "");
  EXPECT_EQ(made.err,
            out() +
                ": 7 objects of 4 materials; to make it a site, name an access point in its "
                "site.toml\n");
  const Finished checked =
      RaylocProcess({"scene", "check", out() + "/scene.xml", "--json", "--frequency", "2.4e9"})
          .wait();
  ASSERT_EQ(checked.status, 0) << checked.err;
  const auto json = nlohmann::json::parse(checked.out);
  EXPECT_EQ(json["name"], "office");
  EXPECT_EQ(json["frequency"], 2.4e9);
  EXPECT_EQ(json["bounds"]["max"], (nlohmann::json{5.2, 3.4, 2.7}));
  EXPECT_EQ(json["surfaces"], 12);
  EXPECT_EQ(json["triangles"], 24);
  EXPECT_EQ(json["objects"].size(), 7U);
  EXPECT_EQ(json["objects"][6]["form"], "closed");
  EXPECT_EQ(json["materials"].size(), 4U);
  EXPECT_TRUE(json["warnings"].empty()) << json["warnings"];
}

TEST_F(SceneVerb, ImportWritesAValidSceneOrLeavesNoTrace) {
  const std::string model = file("room.obj",
                                 "o floor\nv 0 0 0\nv 4 0 0\nv 4 0 -3\nv 0 0 -3\nf 1 2 3 4\n"
                                 "o ceiling\nv 0 2.5 0\nv 4 2.5 0\nv 4 2.5 -3\nv 0 2.5 -3\n"
                                 "f 8 7 6 5\no glass_front\nf 1 2 6 5\n");
  const Finished made = RaylocProcess({"scene", "import", model, "--out", out()}).wait();
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_NE(made.err.find(": 3 objects of 3 materials, 4.00 x 3.00 x 2.50 m\n  OBJ\n"),
            std::string::npos)
      << made.err;
  EXPECT_NE(made.err.find("name an access point in its site.toml"), std::string::npos) << made.err;
  std::ofstream(out() + "/site.toml", std::ios::app) << kAccessPoint;
  const Finished checked = RaylocProcess({"scene", "check", out()}).wait();
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_NE(checked.out.find("glass_front"), std::string::npos) << checked.out;
  // A refused import leaves the drawn scene unchanged.
  const std::string drawn = content(out() + "/scene.xml");
  const Finished refused =
      RaylocProcess(
          {"scene", "import", file("plan.dwg", "AC1032 and so on"), "--force", "--out", out()})
          .wait();
  EXPECT_EQ(refused.status, 65);
  EXPECT_NE(refused.err.find("plan.dwg: is a DWG drawing; export its plan as DXF or SVG"),
            std::string::npos)
      << refused.err;
  EXPECT_EQ(content(out() + "/scene.xml"), drawn);
}

TEST_F(SceneVerb, RoomTakesTheTablesOfItsAntennasAlong) {
  const char* beam = "t,0,90,180,270\n0,1,1,1,1\n90,7,-1,-9,-1\n180,1,1,1,1\n";
  const std::string original = file("beam.csv", beam);
  std::string access_point = kAccessPoint;
  access_point.insert(access_point.find("position"), "pattern_file = \"beam.csv\"\n");
  const Finished made = make_room(kPlan + access_point);
  ASSERT_EQ(made.status, 0) << made.err;
  fs::remove(original);
  EXPECT_EQ(content(fs::path(out()) / "patterns" / "ap1.csv"), beam);
  EXPECT_EQ(RaylocProcess({"check-config", "--quiet", out()}).wait().status, 0);
}

TEST_F(SceneVerb, RoomWithAnAccessPointIsASite) {
  const Finished made = make_room(std::string(kPlan) + kAccessPoint);
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(RaylocProcess({"check-config", "--quiet", out()}).wait().status, 0);
  const Finished checked = RaylocProcess({"scene", "check", out()}).wait();
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_NE(checked.out.find("office: 5.200 x 3.400 x 2.700 m, 7 objects"), std::string::npos)
      << checked.out;
  EXPECT_NE(checked.out.find("\nno warning\n"), std::string::npos) << checked.out;
}

TEST_F(SceneVerb, RoomLacksOnlyAnAccessPointToBeASite) {
  ASSERT_EQ(make_room(kPlan).status, 0);
  std::ofstream(out() + "/site.toml", std::ios::app) << kAccessPoint;
  const Finished checked = RaylocProcess({"check-config", "--quiet", out()}).wait();
  EXPECT_EQ(checked.status, 0) << checked.err;
}

TEST_F(SceneVerb, RoomOverwritesNothingUnlessForced) {
  ASSERT_EQ(make_room(kPlan).status, 0);
  const Finished again = make_room(kPlan);
  EXPECT_EQ(again.status, 64);
  EXPECT_NE(again.err.find("is not empty; choose another --out, or --force"), std::string::npos)
      << again.err;
  EXPECT_EQ(RaylocProcess(
                {"scene", "room", file("office.toml", kPlan), "--out", out(), "--force", "--quiet"})
                .wait()
                .err,
            "");
}

TEST_F(SceneVerb, MistakesInThePlanAreLinesWithTheirPlace) {
  const Finished made = make_room(std::string(kPlan) + "yaw = 3\n[[box]]\nname = \"table\"\n");
  EXPECT_EQ(made.status, 78);
  const std::string name = folder_ / "office.toml";
  EXPECT_EQ(made.err.find(name + ":11:1: unknown key 'yaw' in [[box]]; did you mean 'yaw_deg'?\n"),
            0U)
      << made.err;
  EXPECT_NE(made.err.find(name + ":13:8: a second object 'table'"), std::string::npos) << made.err;
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(SceneVerb, RoomAndImportNameEachOtherForTheFileOfTheOther) {
  const std::string drawing = file("office.dxf", dxf_office());
  const Finished room = RaylocProcess({"scene", "room", drawing, "--out", out()}).wait();
  EXPECT_EQ(room.status, 65);
  EXPECT_NE(room.err.find("rayloc scene import"), std::string::npos) << room.err;
  const std::string plan = file("office.toml", kPlan);
  const Finished imported = RaylocProcess({"scene", "import", plan, "--out", out()}).wait();
  EXPECT_EQ(imported.status, 65);
  EXPECT_NE(imported.err.find("rayloc scene room"), std::string::npos) << imported.err;
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(SceneVerb, CheckWarnsAndStillSucceeds) {
  ASSERT_EQ(make_room(kPlan).status, 0);
  const std::string site = content(out() + "/site.toml") +
                           "[[access_point]]\nid = \"ap1\"\nposition = [2, 1.5, 0.73]\n"
                           "[[access_point.antenna]]\ncore = 0\noffset = [0, 0, 0]\n";
  std::ofstream(out() + "/site.toml") << site;
  const Finished checked = RaylocProcess({"scene", "check", out()}).wait();
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_NE(checked.out.find("warning: the antenna of core 0 of access point 'ap1' is inside of "
                             "object 'table', where it receives nothing\n"),
            std::string::npos)
      << checked.out;
}

class Field : public SceneVerb {
 protected:
  // The office with these steps in to_world of each shape.
  void write_office(const std::string& steps) const {
    const fs::path xml = fs::path(out()) / "scene.xml";
    if (!fs::exists(xml)) {
      ASSERT_EQ(make_room(std::string(kPlan) + kAccessPoint).status, 0);
      fs::copy(xml, folder_ / "office.xml");
    }
    std::string text = content(folder_ / "office.xml");
    const std::string end = "</shape>";
    for (std::size_t at = 0; (at = text.find(end, at)) != std::string::npos;) {
      const std::string transform = R"(<transform name="to_world">)" + steps + "</transform>";
      text.insert(at, transform);
      at += transform.size() + end.size();
    }
    std::ofstream(xml) << text;
  }
  // The message of every verb that loads the site for work.
  std::string refusal() const {
    const Finished checked = RaylocProcess({"check-config", out()}).wait();
    EXPECT_EQ(checked.status, 78);
    EXPECT_EQ(RaylocProcess({"calibrate", out(), "--plan"}).wait().status, 78);
    const Finished inspected = RaylocProcess({"scene", "check", out()}).wait();
    EXPECT_EQ(inspected.status, 78);
    EXPECT_EQ(inspected.err, checked.err);
    return checked.err;
  }
  void expect_good() const {
    const Finished checked = RaylocProcess({"check-config", "--quiet", out()}).wait();
    EXPECT_EQ(checked.status, 0) << checked.err;
    // The only message that is left states that the site is not calibrated.
    EXPECT_EQ(std::count(checked.err.begin(), checked.err.end(), '\n'), 1) << checked.err;
    EXPECT_NE(checked.err.find("the site is not calibrated"), std::string::npos) << checked.err;
  }
};

// The step that the check advises makes the scene valid.
TEST_F(Field, RoomCheckReportsCentimetresAndTheRemedy) {
  write_office(R"(<scale value="100"/>)");
  const std::string message = refusal();
  EXPECT_NE(message.find("its vertices are in centimetres"), std::string::npos) << message;
  EXPECT_NE(message.find(R"(write <scale value="0.01"/> last)"), std::string::npos) << message;
  write_office(R"(<scale value="100"/><scale value="0.01"/>)");
  expect_good();
}

TEST_F(Field, RoomCheckReportsTheUpAxisAndTheRemedy) {
  write_office(R"(<rotate x="1" angle="-90"/>)");
  const std::string message = refusal();
  EXPECT_NE(message.find("its floor and ceiling lie along y"), std::string::npos) << message;
  EXPECT_NE(message.find(R"(write <rotate x="1" angle="90"/> last)"), std::string::npos) << message;
  write_office(R"(<rotate x="1" angle="-90"/><rotate x="1" angle="90"/>)");
  expect_good();
  write_office(R"(<rotate y="1" angle="90"/>)");
  EXPECT_NE(refusal().find(R"(write <rotate y="1" angle="-90"/> last)"), std::string::npos);
  write_office(R"(<rotate y="1" angle="90"/><rotate y="1" angle="-90"/>)");
  expect_good();
}

// A shape's id with an escape sequence, a line end and the same as U+009B.
TEST_F(Field, ShapeIdsDoNotControlTheTerminal) {
  ASSERT_EQ(make_room(std::string(kPlan) + kAccessPoint).status, 0);
  const fs::path xml = fs::path(out()) / "scene.xml";
  std::string text = content(xml);
  const std::string id = "mesh-table";
  text.replace(text.find(id), id.size(), "mesh-&#27;[31mt&#10;able&#155;2J");
  std::ofstream(xml) << text;
  const auto expect_harmless = [](const Finished& finished) {
    for (const std::string& words : {finished.out, finished.err}) {
      EXPECT_EQ(words.find('\x1b'), std::string::npos) << words;
      EXPECT_EQ(words.find("\xc2\x9b"), std::string::npos) << words;
    }
  };
  const Finished checked = RaylocProcess({"scene", "check", out()}).wait();
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_NE(checked.out.find("?[31mt?able?2J"), std::string::npos) << checked.out;
  expect_harmless(checked);
  const Finished traced =
      RaylocProcess({"trace", out(), "--tx", "2,1.5,0.73", "--rx", "1,1,1.2"}).wait();
  EXPECT_NE(traced.err.find("is inside of object '?[31mt"), std::string::npos) << traced.err;
  expect_harmless(traced);
  // An error of the scene names the shape as well.
  fs::remove(fs::path(out()) / "meshes" / "table.ply");
  const Finished broken = RaylocProcess({"check-config", out()}).wait();
  EXPECT_EQ(broken.status, 78);
  EXPECT_NE(broken.err.find("?[31mt"), std::string::npos) << broken.err;
  expect_harmless(broken);
}

TEST_F(Field, RoomCheckOfASceneAloneWarns) {
  write_office(R"(<scale value="1000"/>)");
  const Finished checked = RaylocProcess({"scene", "check", out() + "/scene.xml", "--json"}).wait();
  EXPECT_EQ(checked.status, 0) << checked.err;
  const auto json = nlohmann::json::parse(checked.out);
  ASSERT_EQ(json["warnings"].size(), 1U) << checked.out;
  EXPECT_EQ(json["warnings"][0]["kind"], "scale");
  EXPECT_EQ(json["errors"].size(), 0U);
}

// A scene that cannot be used is named with its place, and nothing is printed as data.
TEST_F(SceneVerb, UnusableScenesAreRefused) {
  ASSERT_EQ(make_room(kPlan).status, 0);
  const std::string xml = out() + "/scene.xml";
  const std::string mesh = out() + "/meshes/table.ply";
  const auto check = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"scene", "check", xml};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RaylocProcess(arguments).wait();
  };
  const auto expect_refused = [&](const Finished& finished, const std::string& message) {
    EXPECT_EQ(finished.status, 65);
    EXPECT_EQ(finished.out, "");
    EXPECT_EQ(finished.err.find(xml), 0U) << finished.err;
    EXPECT_NE(finished.err.find(message), std::string::npos) << finished.err;
  };
  expect_refused(check({"--frequency", "200e9"}),
                 "ITU-R P.2040-4 states 'concrete' for 1 to 100 GHz, not for 200 GHz");

  const std::string good_mesh = content(mesh);
  std::string bad = good_mesh;
  bad.replace(bad.find("end_header\n") + 11, 3, "nan");
  std::ofstream(mesh) << bad;
  expect_refused(check({}), "has a coordinate that is not a finite number");

  bad = good_mesh.substr(0, good_mesh.find("end_header\n") + 11);
  for (int i = 0; i < 8; ++i) {
    bad += std::to_string(i) + " 0 0\n";
  }
  bad += good_mesh.substr(good_mesh.find("\n3 ") + 1);
  std::ofstream(mesh) << bad;
  expect_refused(check({}), "object 'table' has no triangle that is at least a micrometre high");

  fs::remove(mesh);
  expect_refused(check({}), "shape 'table': " + mesh + " does not exist");

  std::string unknown = content(xml);
  unknown.replace(unknown.find("value=\"wood\""), 12, "value=\"woood\"");
  std::ofstream(xml) << unknown;
  expect_refused(check({}), "has no material 'woood'; did you mean 'wood'?");
}

TEST_F(SceneVerb, NeedsASubcommand) {
  EXPECT_EQ(RaylocProcess({"scene"}).wait().status, 64);
  EXPECT_EQ(RaylocProcess({"scene", "room"}).wait().status, 64);
  EXPECT_EQ(RaylocProcess({"scene", "check"}).wait().status, 64);
  const Finished missing = RaylocProcess({"scene", "check", "/nowhere/scene.xml"}).wait();
  EXPECT_EQ(missing.status, 65);
  EXPECT_EQ(missing.err, "/nowhere/scene.xml does not exist\n");
}

TEST_F(SceneVerb, HelpHasAnExample) {
  for (const char* part : {"room", "import", "check"}) {
    const Finished help = RaylocProcess({"scene", part, "--help"}).wait();
    EXPECT_EQ(help.status, 0);
    EXPECT_NE(help.out.find("Example:\n  rayloc scene " + std::string(part)), std::string::npos)
        << help.out;
  }
}

}  // namespace
}  // namespace rayloc::scene_test
