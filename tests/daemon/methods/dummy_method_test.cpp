// A method in a folder of the tests alone is available everywhere, as the others are: the programs
// use one registry. They are linked from the product's own objects.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/daemon/lab/experiment/small_room.h"
#include "tests/e2e/live_daemon.h"
#include "tests/support/eventually.h"
#include "tests/support/rayloc_process.h"
#include "tests/support/test_paths.h"

namespace rayloc::dummy_method_test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

// Every program that a test of this file starts is linked with the dummy method.
[[maybe_unused]] const int kPrograms =
    ::setenv("RAYLOC_BIN", test::program_path("with_dummy").c_str(), 1);

const std::string kSite = test::data_path("/sites/meeting_room");
const std::string kRecording = "ap1=" + kSite + "/device_los-ap1.pcap.gz";

Finished rayloc(std::vector<std::string> arguments) {
  return RaylocProcess(std::move(arguments)).wait();
}

// RaylocProcess reads a pipe that is full at 64 KiB.
std::string long_output(const std::string& arguments) {
  std::FILE* pipe = ::popen((test::program_path("rayloc") + " " + arguments).c_str(), "r");
  std::string text;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
    text.append(buffer.data(), n);
  }
  EXPECT_EQ(::pclose(pipe), 0);
  return text;
}

class Dummy : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
    return folder_.path() / name;
  }
  std::string configuration(const std::string& method) const {
    return write(
        "raylocd.toml",
        "[site]\ndirectory = \"" + kSite +
            "\"\n[[source]]\nkind = \"udp\"\naccess_point = \"ap1\"\n[engine]\nmethod = \"" +
            method + "\"\n");
  }

  e2e::TemporaryFolder folder_;
};

TEST_F(Dummy, LocatesInAReplayThatEvaluateReads) {
  const std::string out = folder_.path() / "dummy.jsonl";
  const Finished replay = rayloc({"replay",
                                  kSite,
                                  kRecording,
                                  "--method",
                                  "dummy",
                                  "--kind",
                                  "device",
                                  "--no-cache",
                                  "--quiet",
                                  "--out",
                                  out});
  ASSERT_EQ(replay.status, 0) << replay.err;
  std::size_t count = 0;
  for (const std::string& line : e2e::read_lines(out)) {
    const auto location = nlohmann::json::parse(line);
    EXPECT_EQ(location.at("quality").at("method"), "dummy");
    EXPECT_EQ(location.at("position").value("x", 0.0), 0.0);
    EXPECT_EQ(location.at("position").value("y", 0.0), 0.0);
    ++count;
  }
  EXPECT_GT(count, 10U);
  const Finished evaluation =
      rayloc({"evaluate", "--estimates", out, "--truth", kSite + "/device_los.csv", "--json"});
  ASSERT_EQ(evaluation.status, 0) << evaluation.err;
  const auto report = nlohmann::json::parse(evaluation.out);
  EXPECT_GT(report.at("n").get<int>(), 10) << evaluation.out;
}

TEST_F(Dummy, RefusesUnsupportedOptions) {
  const Finished people =
      rayloc({"replay", kSite, kRecording, "--method", "dummy", "--kind", "person"});
  EXPECT_EQ(people.status, 64);
  EXPECT_THAT(people.err, HasSubstr("--method dummy locates devices; use --kind device"));
  const Finished likelihood =
      rayloc({"replay", kSite, kRecording, "--method", "dummy", "--likelihood", "coherent"});
  EXPECT_EQ(likelihood.status, 64);
  EXPECT_THAT(likelihood.err, HasSubstr("method dummy has a loss of its own"));
}

TEST_F(Dummy, IsInTheConfigurationOfRaylocd) {
  EXPECT_EQ(rayloc({"check-config", configuration("dummy")}).status, 0);
  const Finished wrong = rayloc({"check-config", configuration("dumy")});
  EXPECT_EQ(wrong.status, 78);
  EXPECT_THAT(wrong.err + wrong.out,
              HasSubstr("'dumy' is no value of 'method'; did you mean 'dummy'?"));
  const Finished offline = rayloc({"check-config", configuration("paper")});
  EXPECT_EQ(offline.status, 78) << "a method that is not live";
  EXPECT_THAT(long_output("config schema"), HasSubstr("\"dummy\""));
  EXPECT_THAT(long_output("config man"), HasSubstr("dummy"));
}

TEST_F(Dummy, IsInHelpAndManualPage) {
  const std::string row = "dummy: the middle of the room; devices; needs the bounds of a room";
  for (const std::string& text : {long_output("replay --help"), long_output("man")}) {
    EXPECT_THAT(text, HasSubstr(row));
  }
  // Its neighbours in the list come and go with other methods.
  EXPECT_THAT(long_output("experiment --help"), ContainsRegex("rayloc, paper, [^;]*, dummy;"));
}

TEST_F(Dummy, IsAnAxisOfAnExperiment) {
  const test::SmallRoomFolder room("dummy-method-test");
  const std::string file = room.write("e.toml", R"(name = "dummy"
[defaults]
room = "room.toml"
spots = 2
frames = 1
depth = 1
model_depth = 1
[[study]]
name = "methods"
method = ["paper", "dummy"]
paper.iterations = 2
)");
  const std::string out = room.path() / "out";
  const Finished finished = rayloc({"experiment", file, "--out", out, "--quiet"});
  ASSERT_EQ(finished.status, 0) << finished.err;
  std::ifstream report(out + "/report.json");
  const auto conditions = nlohmann::json::parse(report)["studies"][0]["conditions"];
  ASSERT_EQ(conditions.size(), 2U);
  const nlohmann::json& dummy = conditions[1];
  EXPECT_EQ(dummy["values"]["method"], "dummy");
  // It is what every report compares with.
  EXPECT_EQ(dummy["statistics"]["median_m"], dummy["statistics"]["room_centre_median_m"]) << dummy;
  const std::string people = room.write("p.toml", R"(name = "people"
[[study]]
name = "people"
room = "room.toml"
kind = "person"
method = "dummy"
)");
  EXPECT_THAT(rayloc({"experiment", people, "--out", out + "2"}).err,
              HasSubstr("method dummy does not locate kind 'person'"));
}

TEST_F(Dummy, LocatesLive) {
  e2e::LiveDaemon daemon(folder_.path(),
                         {.site = kSite, .more_configuration = "[engine]\nmethod = \"dummy\"\n"});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  ASSERT_EQ(e2e::send(folder_.path(),
                      "send",
                      daemon,
                      {"--speed",
                       "8",
                       e2e::bundled_recording("device_los", "ap1"),
                       e2e::bundled_recording("device_los", "ap2"),
                       e2e::bundled_recording("device_los", "ap3")}),
            0);
  ASSERT_TRUE(eventually(std::chrono::seconds(60), [&] {
    return !daemon.bodies("location").empty();
  })) << daemon.errors();
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  for (const nlohmann::json& location : daemon.bodies("location")) {
    EXPECT_EQ(location.at("quality").at("method"), "dummy");
  }
}

}  // namespace
}  // namespace rayloc::dummy_method_test
