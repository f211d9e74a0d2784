// `rayloc simulate` as a process, and what the other verbs make of its recordings.
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "daemon/site/model/room_model.h"
#include "engine/trace/array_tracer.h"
#include "tests/support/closet_plan.h"
#include "tests/support/rayloc_process.h"
#include "tests/support/verb_folder.h"

namespace rayloc::simulate_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Value = std::complex<double>;

// A small room with three access points of three antennas.
constexpr const char* kCabinet = R"([[box]]
name = "cabinet"
material = "metal"
centre = [1.2, -0.9, 0.5]
size = [0.5, 0.4, 1.0]
)";

// Half a second at each of columns x rows places, `shift` metres from a grid of 0.3 m.
std::string points(int columns, int rows, double shift, int start) {
  std::string text = "t_start,t_end,x,y,z\n";
  for (int i = 0; i < columns * rows; ++i) {
    const double x = -1.05 + 0.3 * (i % columns) + shift;
    const int row = i / columns;
    const double y = -0.75 + 0.3 * row - shift;
    const double t = start + 2.0 * i;
    text += std::to_string(t) + "," + std::to_string(t + 0.5) + "," + std::to_string(x) + "," +
            std::to_string(y) + ",1.2\n";
  }
  return text;
}

class SimulateVerb : public test::VerbFolder {
 protected:
  SimulateVerb() : VerbFolder("simulate_" + test_name()) {}

  void SetUp() override {
    write("plan.toml",
          std::string(test::kCloset) + kCabinet +
              test::closet_access_point("ap1", "[-1.3, 1.0, 1.2]", -38) +
              test::closet_access_point("ap2", "[1.35, 0.9, 1.2]", -146) +
              test::closet_access_point("ap3", "[-0.2, -1.05, 1.2]", 79));
    run({"scene", "room", path("plan.toml"), "--out", path("site"), "--quiet"});
  }
  // Recordings of all three access points.
  std::string simulate(const std::string& points_file, const std::string& name, int seed) const {
    return run({"simulate",
                path("site"),
                "--points",
                points_file,
                "--seed",
                std::to_string(seed),
                "--out",
                "ap1=" + path(name + "1.pcap"),
                "ap2=" + path(name + "2.pcap"),
                "ap3=" + path(name + "3.pcap")});
  }
};

TEST_F(SimulateVerb, WithoutImpairmentsFramesGivesTheTracersChannel) {
  const auto file = write("points.csv", "t_start,t_end,x,y,z\n100,101,0.4,-0.2,1.1\n");
  run({"simulate",
       path("site"),
       "--points",
       file,
       "--out",
       "ap2=" + path("a.pcap"),
       "--impairments",
       "none",
       "--frames",
       "1"});
  const std::string out = run({"frames", "ap2=" + path("a.pcap"), "--json", "--values"});
  const auto frame = nlohmann::json::parse(out.substr(0, out.find('\n')));

  const auto site = load_site(path("site"));
  ASSERT_TRUE(site) << site.error().message;
  const auto room = load_room_model(*site);
  ASSERT_TRUE(room) << room.error().message;
  const ArrayTracer tracer(PathTracer(room->scene), room->access_points[1].array);
  const Transmitter device{{{0.4, -0.2, 1.1}, {}, AntennaPattern::kHalfWaveDipole}};
  const auto h = array_csi(tracer.trace(device), room->grid);

  ASSERT_EQ(frame["tone_index"].size(), room->grid.size());
  const std::vector<std::size_t> row_of_element = {1, 0, 2};  // cores 2, 0, 3 of 0, 2, 3
  Value product;
  double own = 0.0;
  double theirs = 0.0;
  for (std::size_t i = 0; i < h.size(); ++i) {
    const std::size_t tones = room->grid.size();
    const auto& pair = frame["csi"][row_of_element[i / tones]][0][i % tones];
    const Value received(pair[0].get<double>(), pair[1].get<double>());
    product += std::conj(h[i]) * received;
    own += std::norm(h[i]);
    theirs += std::norm(received);
  }
  // Rounding to 11 bits is about 72 dB below the signal.
  EXPECT_LT(1.0 - std::norm(product) / (own * theirs), 1e-6);
}

TEST_F(SimulateVerb, TheSameSeedGivesTheSameFileAndOutputIsNeverOverwrittenUnasked) {
  const auto file = write("points.csv", points(2, 1, 0.0, 100));
  const std::vector<std::string> common = {"simulate", path("site"), "--points", file};
  const auto simulated = [&](const std::string& seed, const std::string& name) {
    auto arguments = common;
    arguments.insert(arguments.end(), {"--seed", seed, "--out", "ap1=" + path(name)});
    return RaylocProcess(arguments).wait();
  };
  EXPECT_EQ(simulated("1", "a.pcap").status, 0);
  EXPECT_EQ(simulated("1", "b.pcap").status, 0);
  EXPECT_EQ(simulated("2", "c.pcap").status, 0);
  EXPECT_EQ(read("a.pcap"), read("b.pcap"));
  EXPECT_NE(read("a.pcap"), read("c.pcap"));
  EXPECT_EQ(simulated("1", "c.pcap").status, 69);
  auto forced = common;
  forced.insert(forced.end(), {"--seed", "1", "--force", "--out", "ap1=" + path("c.pcap")});
  run(forced);
  EXPECT_EQ(read("a.pcap"), read("c.pcap"));
}

TEST_F(SimulateVerb, ChannelsDifferByTheErrorsOfTheModelAnewAtEachPoint) {
  const auto file =
      write("points.csv", "t_start,t_end,x,y,z\n100,101,0.4,-0.2,1.2\n200,201,0.4,-0.2,1.2\n");
  const auto channels = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"simulate",
                                          path("site"),
                                          "--points",
                                          file,
                                          "--impairments",
                                          "none",
                                          "--frames",
                                          "1",
                                          "--force",
                                          "--out",
                                          "ap1=" + path("a.pcap")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto report = nlohmann::json::parse(run(arguments));
    EXPECT_EQ(report["model_error"].get<bool>(), !more.empty());
    EXPECT_EQ(report["depth"], more.empty() ? 3 : 2) << "that of a site without a calibration";
    std::vector<nlohmann::json> found;
    std::istringstream lines(run({"frames", "ap1=" + path("a.pcap"), "--json", "--values"}));
    for (std::string line; std::getline(lines, line);) {
      if (const auto json = nlohmann::json::parse(line); json.contains("csi")) {
        found.push_back(json["csi"]);  // the last line counts
      }
    }
    return found;
  };
  const auto traced = channels({});
  ASSERT_EQ(traced.size(), 2U);
  EXPECT_EQ(traced[0], traced[1]);
  const auto drawn = channels({"--model-error"});
  ASSERT_EQ(drawn.size(), 2U);
  EXPECT_NE(drawn[0], drawn[1]);
  EXPECT_EQ(channels({"--model-error"}), drawn);
  EXPECT_NE(channels({"--model-error", "--seed", "1"}), drawn);
}

TEST_F(SimulateVerb, RefusesInvalidInputs) {
  const auto file = write("points.csv", points(2, 1, 0.0, 100));
  const auto radio = write("radio.toml", "snr_db = 20\njitter = 3\n");
  const std::string out = "ap1=" + path("a.pcap");
  Finished finished =
      RaylocProcess(
          {"simulate", path("site"), "--points", file, "--impairments", radio, "--out", out})
          .wait();
  EXPECT_EQ(finished.status, 78);
  EXPECT_THAT(finished.err, HasSubstr("radio.toml:2:1: unknown key 'jitter'"));
  finished =
      RaylocProcess({"simulate", path("site"), "--points", file, "--out", path("a.pcap")}).wait();
  EXPECT_EQ(finished.status, 64);
  EXPECT_THAT(finished.err, HasSubstr("ap1, ap2, ap3"));
  finished =
      RaylocProcess(
          {"simulate", path("site"), "--points", file, "--transmitter", "phone", "--out", out})
          .wait();
  EXPECT_EQ(finished.status, 64);
  EXPECT_THAT(finished.err, HasSubstr("phone"));
  for (const std::vector<std::string>& other :
       {std::vector<std::string>{"--person"}, {"--depth", "2"}, {"--transmission"}}) {
    std::vector<std::string> arguments = {
        "simulate", path("site"), "--points", file, "--out", out, "--model-error"};
    arguments.insert(arguments.end(), other.begin(), other.end());
    finished = RaylocProcess(arguments).wait();
    EXPECT_EQ(finished.status, 64) << other.front();
    EXPECT_THAT(finished.err, HasSubstr(other.front()));
  }
  EXPECT_FALSE(fs::exists(path("a.pcap")));
}

TEST_F(SimulateVerb, ReportsThePointsWithoutAnyPath) {
  const auto file =
      write("points.csv", "t_start,t_end,x,y,z\n100,101,0.4,0.2,1.1\n200,201,9,0.2,1.1\n");
  const Finished finished =
      RaylocProcess({"simulate", path("site"), "--points", file, "--out", "ap1=" + path("a.pcap")})
          .wait();
  EXPECT_EQ(finished.status, 0);
  EXPECT_THAT(finished.err, HasSubstr("no path reaches ap1 from 1 points, the first of line 3"));
  const auto report = nlohmann::json::parse(finished.out);
  EXPECT_EQ(report["access_points"][0]["unheard_lines"], nlohmann::json({3}));
}

// The whole way, with the default impairments: calibrated on one survey, located on another.
TEST_F(SimulateVerb, SimulatedSurveysCalibrateAndLocateToCentimetres) {
  const auto survey = write("survey.csv", points(6, 5, 0.0, 1000));
  const auto truth = write("truth.csv", points(4, 4, 0.11, 5000));
  const auto simulated = nlohmann::json::parse(simulate(survey, "survey", 1));
  run({"calibrate",
       path("site"),
       "--gains-only",
       "--quiet",
       "--points",
       survey,
       "--out",
       path("calibrated"),
       "--capture",
       "ap1=" + path("survey1.pcap"),
       "ap2=" + path("survey2.pcap"),
       "ap3=" + path("survey3.pcap")});
  // The same seed: the same power cycle of the radios.
  simulate(truth, "walk", 1);
  run({"replay",
       path("calibrated"),
       "ap1=" + path("walk1.pcap"),
       "ap2=" + path("walk2.pcap"),
       "ap3=" + path("walk3.pcap"),
       "--burst",
       "0.6s",
       "--out",
       path("fixes.jsonl")});
  const auto evaluated = nlohmann::json::parse(
      run({"evaluate", "--estimates", path("fixes.jsonl"), "--truth", truth, "--json"}));
  EXPECT_EQ(evaluated["n"], 16);
  // In a room with calibrated gains alone, access points contradict each other at times.
  EXPECT_LE(evaluated["missed"].get<int>(), 1);
  EXPECT_LT(evaluated["median_m"].get<double>(), 0.06);

  std::ifstream in(path("calibrated") + "/report.json");
  std::map<std::string, double> found;
  const auto report = nlohmann::json::parse(in);
  for (const auto& parameter : report["parameters"]) {
    found[parameter["name"]] = parameter["value"];
  }
  const double true_phase = simulated["access_points"][0]["chains"][1]["phase_deg"];
  EXPECT_NEAR(std::remainder(found.at("ap1.core0/core2.phase") - true_phase, 360.0), 0.0, 5.0);
}

}  // namespace
}  // namespace rayloc::simulate_test
