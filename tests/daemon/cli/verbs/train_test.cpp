// `rayloc train` and `rayloc replay --method` as processes, on the bundled site.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"

namespace rayloc::train_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kSite = test::data_path("/sites/meeting_room");

Finished rayloc(const std::vector<std::string>& arguments) {
  return RaylocProcess(arguments).wait();
}

std::string content(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string recording(const std::string& name, int access_point) {
  const std::string ap = "ap" + std::to_string(access_point);
  return ap + "=" + kSite + "/" + name + "-" + ap + ".pcap.gz";
}

// A site whose device never changes its power, calibrated and trained once.
class TrainVerb : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    fs::remove_all(folder());
    fs::create_directories(folder());
    fs::copy(kSite, path("site"), fs::copy_options::recursive);
    std::string toml = content(path("site") + "/site.toml");
    const std::string mac = "02:52:4c:00:00:01";
    const std::size_t line = toml.rfind('\n', toml.find(mac)) + 1;
    toml.insert(line, "constant_power = true\n");
    std::ofstream(path("site") + "/site.toml") << toml;
    const Finished calibrated = rayloc({"calibrate",
                                        path("site"),
                                        "--gains-only",
                                        "--quiet",
                                        "--force",
                                        "--capture",
                                        recording("calibration", 1),
                                        recording("calibration", 2),
                                        recording("calibration", 3),
                                        "--points",
                                        kSite + "/calibration.csv",
                                        "--out",
                                        path("calibrated")});
    ASSERT_TRUE(fs::exists(path("calibrated") + "/site.toml")) << calibrated.err;
    trained() = train("calibrated", "trained", {});
  }
  static void TearDownTestSuite() { fs::remove_all(folder()); }

  // The folder of this process: other processes run tests of this file at the same time.
  static std::string folder() {
    return ::testing::TempDir() + "/train_verb_" + std::to_string(::getpid());
  }
  static std::string path(const std::string& name) { return folder() + "/" + name; }
  static Finished& trained() {
    static Finished finished;
    return finished;
  }
  static Finished train(const std::string& site,
                        const std::string& out,
                        const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"train",
                                          path(site),
                                          "--method",
                                          "spotfi",
                                          "--capture",
                                          recording("calibration", 1),
                                          recording("calibration", 2),
                                          recording("calibration", 3),
                                          "--points",
                                          kSite + "/calibration.csv",
                                          "--out",
                                          path(out)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return rayloc(arguments);
  }
  static Finished replay(const std::string& site,
                         int access_points,
                         const std::vector<std::string>& more,
                         const std::string& out) {
    std::vector<std::string> arguments = {"replay",
                                          path(site),
                                          "--method",
                                          "spotfi",
                                          "--quiet",
                                          "--kind",
                                          "device",
                                          "--burst",
                                          "1.2s",
                                          "--out",
                                          path(out)};
    for (int ap = 1; ap <= access_points; ++ap) {
      arguments.insert(arguments.begin() + 2, recording("device_los", ap));
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    return rayloc(arguments);
  }
};

TEST_F(TrainVerb, WritesASiteThatNamesItsTrainingData) {
  ASSERT_EQ(trained().status, 0) << trained().err;
  EXPECT_THAT(trained().err, HasSubstr("held out: median error"));
  const std::string toml = content(path("trained") + "/training/spotfi.toml");
  EXPECT_THAT(toml, HasSubstr("method = \"spotfi\""));
  EXPECT_THAT(toml, HasSubstr("constant_power = [\"02:52:4c:00:00:01\"]"));
  EXPECT_THAT(toml, HasSubstr("[access_point.level]"));
  const auto report =
      nlohmann::json::parse(content(path("trained") + "/training/spotfi-report.json"));
  EXPECT_EQ(report["held_out"]["n"], 14) << "a fifth of 72";
  EXPECT_LT(report["held_out"]["median_m"].get<double>(), 1.0);
  EXPECT_THAT(content(path("trained") + "/site.toml"), HasSubstr("training/spotfi.toml"));
}

TEST_F(TrainVerb, IsTheSameTwice) {
  const Finished again = train("calibrated", "again", {"--quiet"});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(again.err, "");
  EXPECT_EQ(content(path("again") + "/training/spotfi.toml"),
            content(path("trained") + "/training/spotfi.toml"));
}

TEST_F(TrainVerb, LocatesBetterThanTheMiddleOfTheRoom) {
  const Finished finished = replay("trained", 3, {}, "three.jsonl");
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_THAT(content(path("three.jsonl")), HasSubstr("\"method\":\"spotfi\""));
  const Finished evaluation = rayloc({"evaluate",
                                      "--estimates",
                                      path("three.jsonl"),
                                      "--truth",
                                      kSite + "/device_los.csv",
                                      "--site",
                                      path("trained"),
                                      "--json"});
  ASSERT_EQ(evaluation.status, 0) << evaluation.err;
  const auto report = nlohmann::json::parse(evaluation.out);
  EXPECT_EQ(report["missed"], 0);
  EXPECT_LT(report["median_m"].get<double>(), 0.6);
  EXPECT_LT(report["median_m"].get<double>(), 0.7 * report["room_centre_median_m"].get<double>());
}

TEST_F(TrainVerb, LetsOneAccessPointLocateWithAPathLossLaw) {
  ASSERT_EQ(replay("trained", 1, {}, "one.jsonl").status, 0);
  EXPECT_THAT(content(path("one.jsonl")), Not(HasSubstr("a bearing and no range")));
  ASSERT_EQ(replay("calibrated", 1, {}, "none.jsonl").status, 0);
  EXPECT_THAT(
      content(path("none.jsonl")),
      HasSubstr("one access point and no learned level: spotfi has a bearing and no range"));
  ASSERT_EQ(replay("calibrated", 1, {"--baseline", "range=room"}, "room.jsonl").status, 0);
  EXPECT_THAT(content(path("room.jsonl")), HasSubstr("it ends at the walls of the room"));
}

TEST_F(TrainVerb, RefusesInvalidOptionsWithAMessage) {
  const auto refusal = [](const std::vector<std::string>& more) {
    return replay("trained", 1, more, "refused.jsonl");
  };
  EXPECT_THAT(refusal({"--baseline", "gird_m=5"}).err,
              HasSubstr("--baseline gird_m=5: no such setting of spotfi; did you mean 'grid_m'?"));
  EXPECT_EQ(refusal({"--baseline", "gird_m=5"}).status, 64);
  EXPECT_THAT(refusal({"--likelihood", "coherent"}).err, HasSubstr("has a loss of its own"));
  const Finished rayloc_method =
      rayloc({"replay", path("trained"), recording("device_los", 1), "--baseline", "grid_m=0.1"});
  EXPECT_EQ(rayloc_method.status, 64);
  EXPECT_THAT(rayloc_method.err, HasSubstr("--baseline: method rayloc has no such settings"));
  EXPECT_THAT(train("site", "nowhere", {}).err, HasSubstr("is not calibrated"));
  EXPECT_EQ(train("calibrated", "trained", {}).status, 64) << "the folder is not empty";
  EXPECT_EQ(train("calibrated", "nowhere", {"--holdout", "0.9"}).status, 64);
  EXPECT_FALSE(fs::exists(path("nowhere")));
}

Finished replay_of(const std::string& site, const std::string& method, const std::string& kind) {
  return rayloc({"replay",
                 site,
                 recording("device_los", 1),
                 "--quiet",
                 "--burst",
                 "1.2s",
                 "--method",
                 method,
                 "--kind",
                 kind});
}

// The site without its walls, and without what it states of their materials.
TEST_F(TrainVerb, M3ReportsMissingRequirements) {
  const Finished one_channel = replay_of(path("trained"), "m3", "device");
  EXPECT_EQ(one_channel.status, 0) << one_channel.err;
  EXPECT_THAT(one_channel.out,
              HasSubstr("m3 without channel hopping: in 36.3 MHz it separates paths that differ "
                        "by 8.3 m"));
  fs::copy(path("site"), path("open"), fs::copy_options::recursive);
  const auto cut = [](const std::string& file, const char* from, const char* to) {
    std::string text = content(file);
    const std::size_t begin = text.find(from);
    ASSERT_NE(begin, std::string::npos) << file;
    text.erase(begin, text.find(to, begin) - begin);
    std::ofstream(file) << text;
  };
  cut(path("open") + "/scene.xml", "<shape type=\"ply\" id=\"mesh-wall_west\"", "</scene>");
  cut(path("open") + "/site.toml", "[materials.glass]", "[targets]");
  const Finished open = replay_of(path("open"), "m3", "device");
  EXPECT_EQ(open.status, 78);
  EXPECT_THAT(open.err,
              HasSubstr("no vertical plane of 1 m2 or more of the scene bounds the room: m3 needs "
                        "reflectors at known places"));
}

TEST_F(TrainVerb, EveryMethodRefusesTheKindThatItDoesNotLocate) {
  for (const char* method : {"spotfi", "m3", "cifi"}) {
    const Finished finished = replay_of(path("trained"), method, "person");
    EXPECT_EQ(finished.status, 64) << method;
    EXPECT_THAT(
        finished.err,
        HasSubstr("--method " + std::string(method) + " locates devices; use --kind device"));
  }
  for (const char* method : {"widar2", "witraj", "dscp"}) {
    const Finished finished = replay_of(path("trained"), method, "device");
    EXPECT_EQ(finished.status, 64) << method;
    EXPECT_THAT(
        finished.err,
        HasSubstr("--method " + std::string(method) + " locates people; use --kind person"));
  }
}

TEST_F(TrainVerb, BeginsAtTheGivenStart) {
  const auto begun = [](const std::string& method, const std::string& start) {
    return rayloc({"replay",
                   path("trained"),
                   recording("device_los", 1),
                   "--method",
                   method,
                   "--start",
                   start,
                   "--quiet",
                   "--paper",
                   "iterations=0",
                   "--out",
                   path("start.jsonl"),
                   "--kind",
                   "device",
                   "--burst",
                   "10s"});
  };
  const Finished finished = begun("paper", "0.25,-0.5");
  ASSERT_EQ(finished.status, 0) << finished.err;
  const std::string out = content(path("start.jsonl"));
  const auto first = nlohmann::json::parse(out.substr(0, out.find('\n')));
  EXPECT_NEAR(first["position"]["x"].get<double>(), 0.25, 1e-9);
  EXPECT_NEAR(first["position"]["y"].get<double>(), -0.5, 1e-9);
  for (const char* wrong : {"0.25", "0.25,", "0.25;1", "a,b", "1,2,3", "nan,1"}) {
    const Finished refused = begun("paper", wrong);
    EXPECT_EQ(refused.status, 64);
    EXPECT_THAT(refused.err, HasSubstr("write X,Y in metres")) << wrong;
  }
  EXPECT_THAT(begun("spotfi", "0,0").err, HasSubstr("--start: method spotfi takes no start"));
}

// A training with another radio or calibration is refused.
TEST_F(TrainVerb, RefusesATrainingOfAnotherRadioOrCalibration) {
  fs::copy(path("trained"), path("other"), fs::copy_options::recursive);
  const std::string file = path("other") + "/training/spotfi.toml";
  const std::string good = content(file);
  const auto replayed_with = [&](const std::string& text) {
    std::ofstream(file) << text;
    return replay("other", 1, {}, "other.jsonl");
  };
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  const Finished radio = replayed_with(replaced("bandwidth_mhz = 40", "bandwidth_mhz = 80"));
  EXPECT_EQ(radio.status, 78);
  EXPECT_THAT(radio.err,
              HasSubstr("trained at 80 MHz at 5190000000 Hz with ap1, ap2, ap3; the site has 40 "
                        "MHz at 5190000000 Hz with ap1, ap2, ap3: train again"));
  const std::size_t id = good.find("calibration = \"") + 15;
  std::string calibration = good;
  calibration.replace(id, 16, "0123456789abcdef");
  const Finished stale = replayed_with(calibration);
  EXPECT_EQ(stale.status, 78);
  EXPECT_THAT(stale.err, HasSubstr("trained with calibration 0123456789abcdef, the site has"));
  EXPECT_THAT(stale.err, HasSubstr("spotfi.toml:6:"));
  EXPECT_THAT(replayed_with(replaced("\"spotfi\"", "\"m3\"")).err,
              HasSubstr("is of method m3, not of spotfi"));
  EXPECT_THAT(replayed_with(replaced("sigma_psi", "sigma_pis")).err, HasSubstr("sigma_pis"));
}

// A verb that copies a site keeps the training of the same calibration alone.
TEST_F(TrainVerb, IsKeptByACopyOfTheSameCalibration) {
  const Finished second = train("trained", "second", {"--quiet"});
  ASSERT_EQ(second.status, 0) << second.err;
  const Finished chains = rayloc({"calibrate",
                                  path("trained"),
                                  "--gains-only",
                                  "--quiet",
                                  "--force",
                                  "--capture",
                                  recording("calibration", 1),
                                  "--points",
                                  kSite + "/calibration.csv",
                                  "--out",
                                  path("anew")});
  EXPECT_THAT(content(path("second") + "/site.toml"), HasSubstr("training/spotfi.toml"));
  EXPECT_THAT(content(path("anew") + "/site.toml"), Not(HasSubstr("training/spotfi.toml")));
}

}  // namespace
}  // namespace rayloc::train_test
