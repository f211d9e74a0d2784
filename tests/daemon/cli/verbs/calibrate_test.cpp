// `rayloc calibrate` as a process, on the bundled site.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/edited_text.h"
#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"

namespace rayloc::calibrate_test {
namespace {

namespace fs = std::filesystem;

const std::string kSite = test::data_path("/sites/meeting_room");

std::string read_text(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

class CalibrateVerb : public ::testing::Test {
 protected:
  void SetUp() override {
    out_ = fs::path(::testing::TempDir()) /
           (std::string("calibrate_") +
            ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(out_);
  }
  void TearDown() override { fs::remove_all(out_); }

  Finished calibrate(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"calibrate", kSite, "--gains-only", "--out", out_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RaylocProcess(arguments).wait();
  }

  // A site of its own, which a test may change.
  fs::path copied_site() const {
    fs::path site = out_.string() + "_site";
    fs::remove_all(site);
    fs::create_directories(site);
    fs::copy(kSite + "/meshes", site / "meshes");
    fs::copy_file(kSite + "/scene.xml", site / "scene.xml");
    fs::copy_file(kSite + "/site.toml", site / "site.toml");
    return site;
  }

  // The first `rows` points of the survey, with `from` replaced by `to`.
  std::string points(int rows, const std::string& from = "", const std::string& to = "") const {
    std::ifstream in(kSite + "/calibration.csv");
    std::string file = out_.string() + ".csv";
    std::ofstream copy(file);
    std::string line;
    for (int i = 0; i <= rows && std::getline(in, line); ++i) {
      const std::size_t at = from.empty() ? std::string::npos : line.find(from);
      copy << (at == std::string::npos ? line : line.replace(at, from.size(), to)) << '\n';
    }
    return file;
  }

  fs::path out_;
};

TEST_F(CalibrateVerb, WritesASiteWhoseGainsExplainTheHeldOutPoints) {
  const Finished run = calibrate({"--capture",
                                  "ap3=" + kSite + "/calibration-ap3.pcap.gz",
                                  "--points",
                                  kSite + "/calibration.csv"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(run.out.empty());
  for (const char* file : {"site.toml", "scene.xml", "meshes/floor.ply", "calibration.toml"}) {
    EXPECT_TRUE(fs::is_regular_file(out_ / file)) << file;
  }
  std::ifstream in(out_ / "report.json");
  const auto report = nlohmann::json::parse(in);
  const auto& heldout = report.at("heldout").at("ap3");
  EXPECT_GT(heldout.at("after").get<double>(), 0.6);
  EXPECT_GT(heldout.at("after").get<double>(), heldout.at("before").get<double>() + 0.2);
  EXPECT_FALSE(report.at("parameters").empty());
  EXPECT_EQ(read_text(out_ / "calibration.toml").find("access_point.level"), std::string::npos);
}

TEST_F(CalibrateVerb, LearnsTheOffsetOfADeviceOfConstantPower) {
  const fs::path site = copied_site();
  std::string text = read_text(kSite + "/site.toml");
  const std::string device = "role = \"device\"\n";
  ASSERT_NE(text.find(device), std::string::npos);
  text.insert(text.find(device), "constant_power = true\n");
  std::ofstream(site / "site.toml") << text;
  const Finished run = RaylocProcess({"calibrate",
                                      site,
                                      "--gains-only",
                                      "--out",
                                      out_,
                                      "--capture",
                                      "ap3=" + kSite + "/calibration-ap3.pcap.gz",
                                      "--points",
                                      kSite + "/calibration.csv"})
                           .wait();
  fs::remove_all(site);
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string calibration = read_text(out_ / "calibration.toml");
  const std::size_t level = calibration.find("[[access_point.level]]\n");
  ASSERT_NE(level, std::string::npos);
  EXPECT_EQ(calibration.find("transmitter = \"02:52:4c:00:00:01\"", level),
            calibration.find('\n', level) + 1);
  const Finished read =
      RaylocProcess({"replay", out_, "ap3=" + kSite + "/device_los-ap3.pcap.gz"}).wait();
  EXPECT_EQ(read.status, 0) << read.err;
}

// The default method: the room itself is fitted, and what it leaves is a site.
TEST_F(CalibrateVerb, FitsTheRoomToTheSurvey) {
  const Finished run = RaylocProcess({"calibrate",
                                      kSite,
                                      "--out",
                                      out_,
                                      "--points",
                                      kSite + "/calibration.csv",
                                      "--capture",
                                      "ap1=" + kSite + "/calibration-ap1.pcap.gz"})
                           .wait();
  ASSERT_EQ(run.status, 0) << run.err;
  std::ifstream in(out_ / "report.json");
  const auto report = nlohmann::json::parse(in);
  const auto& heldout = report.at("heldout").at("ap1");
  EXPECT_GT(heldout.at("after").get<double>(), 0.8);
  EXPECT_GT(heldout.at("after").get<double>(), heldout.at("before").get<double>() + 0.2);
  EXPECT_EQ(report.at("method"), "joint");
  EXPECT_TRUE(fs::is_regular_file(out_ / "report.html"));
  EXPECT_FALSE(fs::exists(out_ / "calibration.checkpoint.json"));
  // The refined scene is the one that the calibration states the hash of.
  const Finished read =
      RaylocProcess({"replay", out_, "ap1=" + kSite + "/device_los-ap1.pcap.gz"}).wait();
  EXPECT_EQ(read.status, 0) << read.err;
}

// The survey places this point within the cabinet, where no ray of the room reaches it.
TEST_F(CalibrateVerb, NamesThePointThatNoRayReaches) {
  const std::string file = points(1000, "-1.5400,-1.1000,1.2000", "-1.4000,-1.2000,0.4000");
  const Finished run =
      calibrate({"--capture", "ap3=" + kSite + "/calibration-ap3.pcap.gz", "--points", file});
  ASSERT_EQ(run.status, 0) << run.err;
  const auto report = nlohmann::json::parse(read_text(out_ / "report.json"));
  bool named = false;
  for (const auto& one : report.at("refused")) {
    named = named || (one.at("what") == file + ":2 ap3" &&
                      one.at("reason") == "no ray of the calibrated room reaches it");
  }
  EXPECT_TRUE(named) << report.at("refused");
}

// The phases of an empty room belong to the calibration that it was recorded with.
TEST_F(CalibrateVerb, LeavesOutTheReferenceOfAnotherCalibration) {
  const fs::path site = copied_site();
  std::ofstream(site / "reference.toml") << "format = 1\n";
  std::ofstream(site / "site.toml", std::ios::app) << "\n[reference]\nfile = \"reference.toml\"\n";
  const Finished run = RaylocProcess({"calibrate",
                                      site,
                                      "--gains-only",
                                      "--out",
                                      out_,
                                      "--capture",
                                      "ap3=" + kSite + "/calibration-ap3.pcap.gz",
                                      "--points",
                                      kSite + "/calibration.csv"})
                           .wait();
  fs::remove_all(site);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("record the empty room again (rayloc reference)"), std::string::npos)
      << run.err;
  EXPECT_NE(read_text(out_ / "report.json").find("record the empty room again"), std::string::npos);
  const Finished read =
      RaylocProcess({"replay", out_, "ap3=" + kSite + "/device_los-ap3.pcap.gz"}).wait();
  EXPECT_EQ(read.status, 0) << read.err;
}

// Before anything is read: the files that are named do not exist.
TEST_F(CalibrateVerb, RefusesAnOutputThatItMayNotWriteAtOnce) {
  const fs::path site = copied_site();
  const auto to = [&](const fs::path& out, const std::string& force) {
    std::vector<std::string> arguments{
        "calibrate", site, "--capture", "ap1=none.pcap", "--points", "none.csv", "--out", out};
    if (!force.empty()) {
      arguments.push_back(force);
    }
    return RaylocProcess(arguments).wait();
  };
  const Finished input = to(site / ".", "--force");
  EXPECT_EQ(input.status, 64);
  EXPECT_NE(input.err.find("is the site that is read"), std::string::npos) << input.err;
  fs::create_directories(out_ / "mine");
  const Finished full = to(out_, "");
  EXPECT_EQ(full.status, 64);
  EXPECT_NE(full.err.find("is not empty"), std::string::npos) << full.err;
  std::ofstream(site / "calibration.toml") << "format = 1\n";
  std::ofstream(site / "site.toml", std::ios::app)
      << "\n[calibration]\nfile = \"calibration.toml\"\n";
  const Finished again = to(out_ / "new", "");
  EXPECT_EQ(again.status, 78);
  EXPECT_NE(again.err.find("is calibrated already"), std::string::npos) << again.err;
  fs::remove_all(site);
}

TEST_F(CalibrateVerb, RefusesAPointOutsideOfTheRoomByItsRow) {
  const Finished run = calibrate({"--capture",
                                  "ap1=" + kSite + "/calibration-ap1.pcap.gz",
                                  "--points",
                                  points(5, ",1.2000", ",9.0000")});
  EXPECT_EQ(run.status, 65);
  EXPECT_NE(run.err.find(".csv:2: "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("outside of the room"), std::string::npos) << run.err;
  EXPECT_FALSE(fs::exists(out_));
}

// One file each where the other belongs: every file is right for itself.
TEST_F(CalibrateVerb, RefusesExchangedRecordingsByTheirAccessPoints) {
  const Finished run = calibrate({"--capture",
                                  "ap1=" + kSite + "/calibration-ap2.pcap.gz",
                                  "ap2=" + kSite + "/calibration-ap1.pcap.gz",
                                  "--points",
                                  kSite + "/calibration.csv"});
  EXPECT_EQ(run.status, 65);
  EXPECT_NE(run.err.find("are the recordings of the two exchanged?"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("access point 'ap1'"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("access point 'ap2'"), std::string::npos) << run.err;
  EXPECT_FALSE(fs::exists(out_));
}

TEST_F(CalibrateVerb, RefusesExchangedColumnsByTheirRow) {
  const Finished run = calibrate({"--capture",
                                  "ap1=" + kSite + "/calibration-ap1.pcap.gz",
                                  "--points",
                                  points(1000, "x,y", "y,x")});
  EXPECT_EQ(run.status, 65);
  EXPECT_NE(run.err.find("are the columns exchanged?"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find(".csv:"), std::string::npos) << run.err;
}

TEST_F(CalibrateVerb, RefusesTheRecordingOfAnotherTime) {
  const Finished run = calibrate({"--capture",
                                  "ap1=" + kSite + "/device_los-ap1.pcap.gz",
                                  "--points",
                                  kSite + "/calibration.csv"});
  EXPECT_EQ(run.status, 65);
  EXPECT_NE(run.err.find("access point 'ap1' received the device 02:52:4c:00:00:01 from"),
            std::string::npos)
      << run.err;
}

TEST_F(CalibrateVerb, RefusesTooFewPoints) {
  const Finished run =
      calibrate({"--capture", "ap1=" + kSite + "/calibration-ap1.pcap.gz", "--points", points(3)});
  EXPECT_EQ(run.status, 65);
  EXPECT_NE(run.err.find("3 calibration points can be used"), std::string::npos) << run.err;
}

// As few as are taken leave none to check with.
TEST_F(CalibrateVerb, ReportsThatNoPointWasHeldOut) {
  const Finished run =
      calibrate({"--capture", "ap1=" + kSite + "/calibration-ap1.pcap.gz", "--points", points(4)});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("ap1: 4 points, none of them held out\n"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("the accuracy of the calibration is unknown"), std::string::npos)
      << run.err;
  EXPECT_EQ(run.err.find("median error"), std::string::npos) << run.err;
}

TEST_F(CalibrateVerb, ExplainsThatNoPointIsUsable) {
  const fs::path site = copied_site();
  const std::string text = read_text(site / "site.toml");
  std::ofstream(site / "site.toml") << testing::edited_text(text, "core = 2", "core = 1");
  const Finished run = RaylocProcess({"calibrate",
                                      site,
                                      "--gains-only",
                                      "--force",  // else the chain that is missing ends it
                                      "--out",
                                      out_,
                                      "--capture",
                                      "ap1=" + kSite + "/calibration-ap1.pcap.gz",
                                      "--points",
                                      kSite + "/calibration.csv"})
                           .wait();
  fs::remove_all(site);
  EXPECT_EQ(run.status, 65);
  EXPECT_NE(run.err.find("0 calibration points can be used"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("; the first that cannot: "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find(".csv:2 ap1: "), std::string::npos) << run.err;
}

TEST_F(CalibrateVerb, RefusesAnAccessPointThatTheSiteDoesNotHave) {
  const Finished run = calibrate({"--capture",
                                  "attic=" + kSite + "/calibration-ap1.pcap.gz",
                                  "--points",
                                  kSite + "/calibration.csv"});
  EXPECT_EQ(run.status, 64);
  EXPECT_NE(run.err.find("no access point 'attic'"), std::string::npos) << run.err;
}

// A site that states the first access point as `to` where it is `from`.
class Field : public CalibrateVerb {
 protected:
  void SetUp() override {
    CalibrateVerb::SetUp();
    site_ = copied_site();
  }
  void TearDown() override {
    fs::remove_all(site_);
    CalibrateVerb::TearDown();
  }

  void state(const std::string& from, const std::string& to) const {
    const std::string text = read_text(kSite + "/site.toml");
    std::ofstream(site_ / "site.toml") << testing::edited_text(text, from, to);
  }
  Finished calibrate_gains(const std::vector<std::string>& more = {}) const {
    return calibrate_points(points(kRows), more);
  }
  Finished calibrate_points(const std::string& points,
                            const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"calibrate",
                                          site_,
                                          "--gains-only",
                                          "--out",
                                          out_,
                                          "--capture",
                                          "ap1=" + kSite + "/calibration-ap1.pcap.gz",
                                          "--points",
                                          points};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RaylocProcess(arguments).wait();
  }
  nlohmann::json verdict() const {
    return nlohmann::json::parse(read_text(out_ / "report.json")).at("verdict");
  }

  static constexpr int kRows = 50;
  fs::path site_;
};

TEST_F(Field, CalibrateReportsARotatedAccessPointAndWritesNoSite) {
  state("yaw_deg = -37", "yaw_deg = 143");
  const Finished refused = calibrate_gains({"--quiet"});
  EXPECT_EQ(refused.status, 79) << refused.err;
  for (const char* part : {"access point 'ap1'",
                           "rotated by 180 degrees",
                           "yaw_deg = -37 instead of 143",
                           "no site was written",
                           "--force writes the site all the same"}) {
    EXPECT_NE(refused.err.find(part), std::string::npos) << part << "\n" << refused.err;
  }
  EXPECT_FALSE(fs::exists(out_ / "site.toml"));
  EXPECT_FALSE(fs::exists(out_ / "calibration.toml"));
  EXPECT_FALSE(verdict().at("success"));
  EXPECT_EQ(verdict().at("explained_by").size(), 1U);
  EXPECT_NE(read_text(out_ / "report.html").find("This calibration is no success"),
            std::string::npos);

  // The refused output does not block the next calibration.
  state("yaw_deg = -37", "yaw_deg = -37");
  const Finished right = calibrate_gains();
  EXPECT_EQ(right.status, 0) << right.err;
  EXPECT_TRUE(fs::exists(out_ / "site.toml"));
  EXPECT_TRUE(verdict().at("success"));
}

// A plan explains a survey on the neighbouring channel as well: only the datagrams show the
// mistake.
TEST_F(Field, CalibrateNamesTheChannelThatTheRecordingIsOf) {
  state("centre_hz = 5190000000", "centre_hz = 5230000000");
  const std::string text = read_text(site_ / "site.toml");
  std::ofstream(site_ / "site.toml") << testing::edited_text(text, "channel = 36", "channel = 44");
  const Finished refused = calibrate_gains();
  EXPECT_EQ(refused.status, 65) << refused.err;
  for (const char* part :
       {"ap1", "5190 MHz (40 MHz wide)", "5230 MHz (40 MHz wide)", "centre_hz"}) {
    EXPECT_NE(refused.err.find(part), std::string::npos) << part << "\n" << refused.err;
  }
  EXPECT_FALSE(fs::exists(out_ / "site.toml"));
}

TEST_F(Field, CalibrateWritesAWorseSiteOnlyWhenForced) {
  state("core = 2", "core = X");
  const std::string text = read_text(site_ / "site.toml");
  std::ofstream(site_ / "site.toml") << testing::edited_text(
      testing::edited_text(text, "core = 0", "core = 2"), "core = X", "core = 0");
  const Finished refused = calibrate_gains();
  EXPECT_EQ(refused.status, 79) << refused.err;
  EXPECT_NE(refused.err.find("with cores 0 and 2 exchanged"), std::string::npos) << refused.err;
  EXPECT_FALSE(fs::exists(out_ / "site.toml"));
  const Finished forced = calibrate_gains({"--force"});
  EXPECT_EQ(forced.status, 79) << forced.err;
  EXPECT_NE(forced.err.find("with cores 0 and 2 exchanged"), std::string::npos) << forced.err;
  EXPECT_EQ(forced.err.find("no site was written"), std::string::npos) << forced.err;
  EXPECT_TRUE(fs::exists(out_ / "site.toml"));
  EXPECT_FALSE(verdict().at("success"));
}

TEST_F(Field, CalibrateStillRefusesAFolderThatHoldsMoreThanItsReports) {
  fs::create_directories(out_);
  std::ofstream(out_ / "report.json") << "{}";
  std::ofstream(out_ / "notes.txt") << "mine";
  const Finished run = calibrate_gains();
  EXPECT_EQ(run.status, 64);
  EXPECT_NE(run.err.find("is not empty"), std::string::npos) << run.err;
}

// Points whose rows are in disorder: no mistake that has a name, and no calibration.
TEST_F(Field, CalibrateRejectsASurveyInDisorder) {
  std::ifstream in(kSite + "/calibration.csv");
  std::vector<std::string> times;
  std::vector<std::string> places;
  std::string header;
  std::getline(in, header);
  for (std::string line; times.size() < kRows && std::getline(in, line);) {
    const std::size_t at = line.find(',', line.find(',') + 1);
    times.push_back(line.substr(0, at));
    places.push_back(line.substr(at));
  }
  std::mt19937_64 random(1);
  for (std::size_t i = places.size(); i > 1; --i) {
    std::swap(places[i - 1], places[random() % i]);
  }
  const std::string file = out_.string() + "_disorder.csv";
  std::ofstream out(file);
  out << header << '\n';
  for (std::size_t i = 0; i < times.size(); ++i) {
    out << times[i] << places[i] << '\n';
  }
  out.close();
  const Finished run = calibrate_points(file);
  EXPECT_EQ(run.status, 79) << run.err;
  EXPECT_NE(run.err.find("have no fix"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("usual mistakes explains the survey clearly better"), std::string::npos)
      << run.err;
  EXPECT_FALSE(fs::exists(out_ / "site.toml"));
  fs::remove(file);
}

}  // namespace
}  // namespace rayloc::calibrate_test
