// A room whose walls, array and chains differ from its site as known: recorded by `rayloc simulate`
// in the room as built, calibrated by `rayloc calibrate` on the site as planned.
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/lab/calibrate/calibrated_site.h"
#include "daemon/site/model/room_model.h"
#include "daemon/site/model/site_copy.h"
#include "engine/base/constants.h"
#include "engine/calibrate/joint/room_unknowns.h"
#include "engine/scene/moved_surfaces.h"
#include "tests/support/edited_text.h"
#include "tests/support/eventually.h"
#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"

namespace rayloc::calibrate_closed_loop_test {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kPatience{120};

const std::string kSite = test::data_path("/sites/meeting_room");

// [m] along the normals of the faces that look into the room.
const std::map<std::string, double>& moved_walls() {
  static const std::map<std::string, double> kMoved{{"wall_west.+x.offset", 0.008},
                                                    {"wall_east.-x.offset", -0.007},
                                                    {"wall_south.+y.offset", -0.006},
                                                    {"wall_north.-y.offset", 0.009}};
  return kMoved;
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class CalibrateClosedLoop : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(::testing::TempDir()) /
        (std::string("closed_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    build();
  }
  void TearDown() override { fs::remove_all(folder_); }

  // The survey of every n-th point of the site, recorded in the room as built.
  void survey(std::size_t every) {
    std::ifstream in(kSite + "/calibration.csv");
    std::string points;
    std::string line;
    for (std::size_t i = 0; std::getline(in, line); ++i) {
      points += i == 0 || (i - 1) % every == 0 ? line + "\n" : "";
    }
    ASSERT_TRUE(write_file(folder_ / "points.csv", points));
    const Finished run = RaylocProcess({"simulate",
                                        folder_ / "built",
                                        "--points",
                                        folder_ / "points.csv",
                                        "--survey-error",
                                        "0.005",
                                        "--depth",
                                        "3",
                                        "--seed",
                                        "3",
                                        "--out",
                                        "ap1=" + (folder_ / "ap1.pcap").string()})
                             .wait();
    ASSERT_EQ(run.status, 0) << run.err;
    simulated_ = nlohmann::json::parse(run.out);
  }

  // The site with the walls moved, and ap1 4 mm, 3 mm and a degree off.
  void build() {
    const auto room = load_room_model(load_site(kSite).value()).value();
    const RoomUnknowns unknowns(room, {});
    std::vector<double> offset(room.scene->surfaces().size());
    std::size_t moved = 0;
    for (std::size_t i = 0; i < offset.size(); ++i) {
      const auto wall = moved_walls().find(to_string(parameter_id(unknowns[i], room)));
      if (wall != moved_walls().end()) {
        offset[i] = wall->second;
        ++moved;
      }
    }
    ASSERT_EQ(moved, moved_walls().size());
    fs::create_directories(folder_);
    fs::copy(kSite, folder_ / "built", fs::copy_options::recursive);
    const Scene scene = move_surfaces(*room.scene, offset).value();
    for (const auto& [name, content] : refined_scene(scene)) {
      ASSERT_TRUE(write_file(folder_ / "built" / name, content));
    }
    std::string toml = text_of(kSite + "/site.toml");
    toml = toml.substr(0, toml.find("# build-up"));  // the scene states its materials
    toml = testing::edited_text(toml, "[-1.4, 1.05, 1.2]", "[-1.396, 1.047, 1.2]");
    toml = testing::edited_text(toml, "yaw_deg = -37", "yaw_deg = -36");
    ASSERT_TRUE(write_file(folder_ / "built/site.toml", toml));
  }

  std::vector<std::string> command(const std::string& site,
                                   const std::string& out,
                                   const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"calibrate",
                                       site,
                                       "--points",
                                       folder_ / "points.csv",
                                       "--capture",
                                       "ap1=" + (folder_ / "ap1.pcap").string(),
                                       "--quiet",
                                       "--out",
                                       folder_ / out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  Finished calibrate(const std::string& out, const std::vector<std::string>& more = {}) const {
    return calibrate_site(kSite, out, more);
  }
  Finished calibrate_site(const std::string& site,
                          const std::string& out,
                          const std::vector<std::string>& more) const {
    return RaylocProcess(command(site, out, more)).wait();
  }
  nlohmann::json report(const std::string& out) const {
    return nlohmann::json::parse(text_of(folder_ / out / "report.json"));
  }

  fs::path folder_;
  nlohmann::json simulated_;
};

TEST_F(CalibrateClosedLoop, RecoversTheRoomAsBuilt) {
  ASSERT_NO_FATAL_FAILURE(survey(1));
  const Finished run = calibrate("out");
  ASSERT_EQ(run.status, 0) << run.err;
  std::map<std::string, std::pair<double, double>> found;  // value and sigma
  const nlohmann::json stated = report("out");
  for (const auto& one : stated.at("parameters")) {
    const auto& sigma = one.at("sigma");
    found[one.at("name")] = {one.at("value"), sigma.is_null() ? 0.0 : sigma.get<double>()};
  }
  const auto near = [&](const std::string& name, double truth, double tolerance) {
    ASSERT_TRUE(found.contains(name)) << name;
    const auto [value, sigma] = found.at(name);
    EXPECT_NEAR(value, truth, tolerance) << name;
    EXPECT_LT(std::abs(value - truth), 4.0 * sigma) << name;
  };
  for (const auto& [wall, truth] : moved_walls()) {
    near(wall, truth, 0.003);
  }
  near("ap1.position.x", 0.004, 0.002);
  near("ap1.position.y", -0.003, 0.002);
  // All points are at the array's height: only floor and ceiling determine z.
  ASSERT_TRUE(found.contains("ap1.position.z"));
  EXPECT_LT(std::abs(found.at("ap1.position.z").first), 4.0 * found.at("ap1.position.z").second);
  near("ap1.yaw", kDegree, 0.2 * kDegree);
  for (const std::size_t chain : {1U, 2U}) {
    const auto& truth = simulated_.at("access_points").at(0).at("chains").at(chain);
    const std::string name =
        "ap1.core" + std::to_string(truth.at("core").get<int>()) + "/core2.phase";
    ASSERT_TRUE(found.contains(name)) << name;
    const auto [value, sigma] = found.at(name);
    const double off = std::remainder(value - truth.at("phase_deg").get<double>(), 360.0);
    // Two of the stated deviations, which are 3 degrees: other draws of what is held out (--seed 1
    // to 4) were off by -3.5, -1.4, -1.1 and 0.4.
    EXPECT_NEAR(off, 0.0, 6.0) << name;
    EXPECT_LT(std::abs(off), 4.0 * sigma) << name;
  }
  EXPECT_FALSE(found.contains("ap1.yaw_offset")) << "it is ap1.yaw";
  const std::string written = text_of(folder_ / "out/calibration.toml");
  EXPECT_NE(written.find("name = \"ap1.core0/core2.phase\"\nunit = \"deg\""), std::string::npos);
}

TEST_F(CalibrateClosedLoop, AnInterruptedCalibrationIsASiteAndGoesOn) {
  ASSERT_NO_FATAL_FAILURE(survey(6));
  const RaylocProcess interrupted(command(kSite, "stopped", {}));
  const fs::path checkpoint = folder_ / "stopped/calibration.checkpoint.json";
  const auto has_round = [&] {  // written at the start with none
    const std::string text = text_of(checkpoint);
    return !text.empty() && nlohmann::json::parse(text).at("rounds") > 0;
  };
  ASSERT_TRUE(eventually(kPatience, has_round));
  interrupted.signal(SIGINT);
  const Finished stopped = interrupted.wait();
  EXPECT_EQ(stopped.status, 128 + SIGINT) << stopped.err;
  EXPECT_NE(stopped.err.find("--resume goes on"), std::string::npos) << stopped.err;
  const auto room = load_room_model(load_site(folder_ / "stopped").value());
  EXPECT_TRUE(room) << room.error().message;
  EXPECT_TRUE(fs::exists(checkpoint));

  // With another orientation of an access point, the same parameters describe another room.
  fs::copy(kSite, folder_ / "turned", fs::copy_options::recursive);
  ASSERT_TRUE(write_file(
      folder_ / "turned/site.toml",
      testing::edited_text(text_of(kSite + "/site.toml"), "yaw_deg = -37", "yaw_deg = -36")));
  const Finished rotated = calibrate_site(folder_ / "turned", "stopped", {"--resume"});
  EXPECT_EQ(rotated.status, 65);
  EXPECT_NE(rotated.err.find("was made from other inputs"), std::string::npos) << rotated.err;

  const Finished resumed = calibrate("stopped", {"--resume"});
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  ASSERT_EQ(calibrate("whole").status, 0);
  EXPECT_EQ(text_of(folder_ / "stopped/calibration.toml"),
            text_of(folder_ / "whole/calibration.toml"));
  EXPECT_EQ(text_of(folder_ / "stopped/scene.xml"), text_of(folder_ / "whole/scene.xml"));
  EXPECT_FALSE(fs::exists(checkpoint));
  const auto course = [&](const std::string& out) {
    return report(out).at("methods").at("joint").at("history");
  };
  EXPECT_EQ(course("stopped"), course("whole"));
}

// The published method keeps nothing that --resume could go on from.
TEST_F(CalibrateClosedLoop, PromisesToGoOnOnlyWhereItCan) {
  ASSERT_NO_FATAL_FAILURE(survey(3));
  const RaylocProcess interrupted(command(kSite, "stopped", {"--method", "paper", "--compare"}));
  ASSERT_TRUE(eventually(kPatience, [&] { return fs::exists(folder_ / "stopped"); }));
  interrupted.signal(SIGINT);
  const Finished stopped = interrupted.wait();
  EXPECT_EQ(stopped.status, 128 + SIGINT) << stopped.err;
  EXPECT_NE(stopped.err.find("holds the last good state"), std::string::npos) << stopped.err;
  EXPECT_EQ(stopped.err.find("--resume"), std::string::npos) << stopped.err;
  EXPECT_EQ(report("stopped").at("methods").size(), 1U);
}

TEST_F(CalibrateClosedLoop, ReportsBothMethodsSideBySide) {
  ASSERT_NO_FATAL_FAILURE(survey(4));
  const Finished run = calibrate("paper", {"--method", "paper", "--compare"});
  ASSERT_EQ(run.status, 0) << run.err;
  const auto json = report("paper");
  EXPECT_EQ(json.at("method"), "paper");
  ASSERT_EQ(json.at("methods").size(), 2U);
  for (const char* method : {"joint", "paper"}) {
    const auto& one = json.at("methods").at(method);
    EXPECT_FALSE(one.at("history").empty()) << method;
    EXPECT_GT(one.at("heldout").at("ap1").at("after"), one.at("heldout").at("ap1").at("before"))
        << method;
  }
}

}  // namespace
}  // namespace rayloc::calibrate_closed_loop_test
