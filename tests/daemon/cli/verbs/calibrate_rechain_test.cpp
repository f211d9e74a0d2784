// Tests `rayloc calibrate --rechain` as a process against the ground truth of `rayloc simulate`.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "capture/source/pcap_source.h"
#include "daemon/pipeline/device_estimator.h"
#include "daemon/site/model/site.h"
#include "tests/support/closet_plan.h"
#include "tests/support/rayloc_process.h"

namespace rayloc::calibrate_rechain_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

constexpr const char* kFixed = R"(
[[transmitter]]
role = "fixed"
mac = "02:52:4c:00:00:09"
name = "plug"
position = [1.2, -0.4, 0.6]
)";
constexpr const char* kRadio = "coupling_db = 0\n";
constexpr const char* kHeader = "t_start,t_end,x,y,z\n";
constexpr double kTolerance = 3.0;  // [degrees]

class RechainVerb : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(::testing::TempDir()) /
        (std::string("rechain_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    write("plan.toml", test::closet_plan());
    write("radio.toml", kRadio);
    run({"scene", "room", path("plan.toml"), "--out", path("site"), "--quiet"});
    std::ofstream(path("site") + "/site.toml", std::ios::app) << kFixed;
    std::string survey = kHeader;
    for (int i = 0; i < 30; ++i) {
      const int row = i / 6;
      survey += std::to_string(1000 + 2 * i) + "," + std::to_string(1000.5 + 2 * i) + "," +
                std::to_string(-1.05 + 0.4 * (i % 6)) + "," + std::to_string(-0.75 + 0.3 * row) +
                ",1.2\n";
    }
    simulate("1", "survey", write("survey.csv", survey), "");
    run({"calibrate",
         path("site"),
         "--gains-only",
         "--quiet",
         "--points",
         path("survey.csv"),
         "--capture",
         path("survey.pcap"),
         "--out",
         path("calibrated")});
    forget_yaw();
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ / name; }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }
  // The room shall be known exactly: the tenths of a degree that a survey of 30 points leaves in
  // the yaw are degrees in the phases.
  void forget_yaw() const { set_calibrated("yaw_offset", "0"); }
  void set_calibrated(const std::string& name, const std::string& value) const {
    std::ifstream in(path("calibrated") + "/calibration.toml");
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const std::string key = name + " = { value = ";
    const auto begin = text.find(key) + key.size();
    text.replace(begin, text.find(',', begin) - begin, value);
    std::ofstream(path("calibrated") + "/calibration.toml") << text;
  }
  static json parse_file(const std::string& file) {
    std::ifstream in(file);
    return json::parse(in);
  }
  static std::string run(const std::vector<std::string>& arguments) {
    const Finished finished = RaylocProcess(arguments).wait();
    EXPECT_EQ(finished.status, 0) << finished.err;
    return finished.out;
  }
  // Returns the ground truth. Another seed is another power cycle.
  json simulate(const std::string& seed,
                const std::string& name,
                const std::string& points,
                const std::string& transmitter) const {
    std::vector<std::string> arguments = {"simulate",
                                          path("site"),
                                          "--points",
                                          points,
                                          "--seed",
                                          seed,
                                          "--impairments",
                                          path("radio.toml"),
                                          "--out",
                                          path(name + ".pcap")};
    if (!transmitter.empty()) {
      arguments.insert(arguments.end(), {"--transmitter", transmitter});
    }
    return json::parse(run(arguments));
  }
  Finished rechain(const std::string& name, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"calibrate",
                                          path("calibrated"),
                                          "--rechain",
                                          "--capture",
                                          "ap1=" + path(name + ".pcap"),
                                          "--out",
                                          path(name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RaylocProcess(arguments).wait();
  }
  // The median error [m] of `site` on a recording.
  double median_error(const std::string& site,
                      const std::string& recording,
                      const std::string& truth) const {
    run({"replay",
         path(site),
         "ap1=" + path(recording + ".pcap"),
         "--burst",
         "1.2s",
         "--out",
         path(site + ".jsonl")});
    const json evaluated = json::parse(
        run({"evaluate", "--estimates", path(site + ".jsonl"), "--truth", truth, "--json"}));
    EXPECT_EQ(evaluated["missed"], 0);
    return evaluated["median_m"];
  }
  void expect_true_chains(const std::string& name, const json& truth) const {
    const json report = parse_file(path(name) + "/report.json");
    const json& chains = report["access_points"][0]["chains"];
    ASSERT_EQ(chains.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      const double phase = truth["access_points"][0]["chains"][i + 1]["phase_deg"];
      const double found = chains[i]["after"]["phase_deg"];
      const double before = chains[i]["before"]["phase_deg"];
      EXPECT_LT(std::abs(std::remainder(found - phase, 360.0)), kTolerance) << name << " " << i;
      EXPECT_GT(std::abs(std::remainder(before - phase, 360.0)), 2.0 * kTolerance);
      EXPECT_GT(chains[i]["sigma"]["phase_deg"].get<double>(), 0.0);
    }
    EXPECT_NE(report["calibration_id"], report["room_calibration_id"]);
  }

  fs::path folder_;
};

TEST_F(RechainVerb, FindsTheNewPhasesFromOnePointThreePointsAndTheFixedTransmitter) {
  const std::string one = write("one.csv", std::string(kHeader) + "5000,5001,0.4,-0.2,1.2\n");
  const std::string three = write("three.csv",
                                  std::string(kHeader) +
                                      "5000,5001,0.4,-0.2,1.2\n5002,5003,-0.5,-0.6,1.2\n"
                                      "5004,5005,0.9,0.3,1.2\n");
  const std::string plug = write("plug.csv", std::string(kHeader) + "5000,5003,1.2,-0.4,0.6\n");
  const json truth_one = simulate("7", "one", one, "");
  const json truth_three = simulate("8", "three", three, "");
  const json truth_plug = simulate("9", "plug", plug, "plug");

  Finished finished = rechain("one", {"--points", one});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_THAT(finished.err, HasSubstr("core 0 against 2: phase"));
  expect_true_chains("one", truth_one);
  finished = rechain("three", {"--points", three, "--quiet"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(finished.err, "");
  expect_true_chains("three", truth_three);
  finished = rechain("plug", {});
  EXPECT_EQ(finished.status, 0) << finished.err;
  expect_true_chains("plug", truth_plug);

  // Fifteen positions, located by one access point in the planned room: the median error with the
  // renewed chains is less than half of that without. The test shows the effect of the chain phases
  // and claims no accuracy.
  std::string rows = kHeader;
  for (int i = 0; i < 15; ++i) {
    const int row = i / 5;
    rows += std::to_string(5000 + 2 * i) + "," + std::to_string(5001 + 2 * i) + "," +
            std::to_string(-1.2 + 0.6 * (i % 5)) + "," + std::to_string(-0.8 + 0.7 * row) +
            ",1.2\n";
  }
  const std::string again = write("again.csv", rows);
  simulate("8", "again", again, "");
  const double renewed = median_error("three", "again", again);
  const double without = median_error("calibrated", "again", again);
  std::printf("median error with the chains renewed %.3f m, without %.3f m\n", renewed, without);
  EXPECT_LT(renewed, 0.6);
  EXPECT_GT(without, 2.0 * renewed);
}

class Forget : public LocationSink {
 public:
  void location(Location&& /*location*/) override {}
};

// The calibration warnings of the daemon's estimator after each recording, and after a restart.
std::vector<std::vector<CalibrationWarning>> warnings_of(const std::string& site_folder,
                                                         const std::vector<std::string>& files) {
  const Site site = load_site(site_folder).value();
  const auto estimator = DeviceEstimator::create(site, {}).value();
  std::vector<std::vector<CalibrationWarning>> warnings;
  for (const std::string& file : files) {
    std::vector<SourceWorker::Input> inputs(1);
    inputs[0].access_point = "ap1";
    inputs[0].source = PcapFileSource::open(file).value();
    inputs[0].receiver.access_point = 0;
    Forget sink;
    PipelineOptions options;
    options.overflow = Overflow::kWait;
    Pipeline pipeline(options, std::move(inputs), *estimator, sink);
    pipeline.start();
    pipeline.wait();
    warnings.push_back(estimator->calibration_warnings());
  }
  Estimates ended;
  estimator->restart("moved", ended);
  warnings.push_back(estimator->calibration_warnings());
  return warnings;
}

TEST_F(RechainVerb, ThePipelineWarnsOfANewPowerCycleAndNotOfTheOldOne) {
  std::string points = kHeader;
  for (int i = 0; i < 20; ++i) {
    points +=
        std::to_string(5000 + 2 * i) + "," + std::to_string(5000.2 + 2 * i) + ",1.2,-0.4,0.6\n";
  }
  const std::string plug = write("plug.csv", points);
  simulate("1", "same", plug, "plug");
  simulate("7", "other", plug, "plug");
  const auto warnings =
      warnings_of(path("calibrated"), {path("same.pcap"), path("same.pcap"), path("other.pcap")});
  EXPECT_TRUE(warnings[0].empty()) << warnings[0][0].text;
  EXPECT_TRUE(warnings[1].empty()) << warnings[1][0].text;
  ASSERT_FALSE(warnings[2].empty());
  EXPECT_THAT(warnings[2][0].text, HasSubstr("chain_phase_jump: access point ap1, core "));
  EXPECT_TRUE(warnings[3].empty()) << "of another time of the recording";
}

TEST_F(RechainVerb, RefusesUnusableInputs) {
  const std::string one = write("one.csv", std::string(kHeader) + "5000,5001,0.4,-0.2,1.2\n");
  simulate("7", "one", one, "");
  // The recording holds no fixed transmitter, and a device at one place.
  Finished finished = rechain("one", {});
  EXPECT_EQ(finished.status, 65);
  EXPECT_THAT(finished.err,
              HasSubstr("access point ap1: the frames of devices are too few to learn its chains"));
  EXPECT_THAT(finished.err, HasSubstr("a device that is carried through the room"));
  EXPECT_FALSE(fs::exists(path("one")));
  finished = RaylocProcess({"calibrate",
                            path("site"),
                            "--rechain",
                            "--capture",
                            path("one.pcap"),
                            "--points",
                            one,
                            "--out",
                            path("x")})
                 .wait();
  EXPECT_EQ(finished.status, 78);
  EXPECT_THAT(finished.err, HasSubstr("is not calibrated"));
  finished = RaylocProcess({"calibrate", path("calibrated"), "--rechain"}).wait();
  EXPECT_EQ(finished.status, 64);
  finished = RaylocProcess({"calibrate",
                            path("calibrated"),
                            "--rechain",
                            "--capture",
                            path("one.pcap"),
                            "--points",
                            one,
                            "--force",
                            "--out",
                            path("calibrated")})
                 .wait();
  EXPECT_EQ(finished.status, 64);
  EXPECT_THAT(finished.err, HasSubstr("is the site that is read"));
}

}  // namespace
}  // namespace rayloc::calibrate_rechain_test
