// Tests `rayloc train` of the methods that learn from places, and `rayloc replay` of those for
// people, as processes on recordings of `rayloc simulate`.
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/closet_plan.h"
#include "tests/support/eventually.h"
#include "tests/support/rayloc_process.h"

namespace rayloc::train_places_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr const char* kTransmitters = R"(
[person]
radius_m = 0.16
height_m = 1.7
[[transmitter]]
role = "fixed"
mac = "02:52:4c:00:00:09"
name = "plug"
position = [1.2, -0.6, 1.1]
)";

std::string content(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct Place {
  double x = 0.0;
  double y = 0.0;
};

class TrainPlaces : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    fs::remove_all(folder());
    fs::create_directories(folder());
    const std::string plan =
        test::closet_plan() + test::closet_access_point("ap2", "[1.3, 1.0, 1.2]", -142);
    std::ofstream(path("plan.toml")) << plan;
    run({"scene", "room", path("plan.toml"), "--out", path("site"), "--quiet"});
    std::ofstream(path("site") + "/site.toml", std::ios::app) << kTransmitters;
    simulate("survey", survey_rows(1000.0, grid(), "1.2"), {});
    run({"calibrate",
         path("site"),
         "--gains-only",
         "--quiet",
         "--points",
         path("survey.csv"),
         "--capture",
         capture(1, "survey"),
         capture(2, "survey"),
         "--out",
         path("calibrated")});
    simulate("empty", survey_rows(2000.0, {{1.2, -0.6}}, "1.1"), {"--transmitter", "plug"});
    simulate("people", survey_rows(3000.0, people(), "0"), {"--transmitter", "plug", "--person"});
    run({"reference",
         path("calibrated"),
         "--capture",
         capture(1, "empty"),
         capture(2, "empty"),
         "--quiet",
         "--out",
         path("reference")});
  }
  static void TearDownTestSuite() { fs::remove_all(folder()); }

  static std::vector<Place> grid() {
    constexpr std::size_t kPlaces = 30;
    std::vector<Place> places;
    places.reserve(kPlaces);
    for (const double y : {-0.75, -0.45, -0.15, 0.15, 0.45}) {
      for (const double x : {-1.05, -0.65, -0.25, 0.15, 0.55, 0.95}) {
        places.push_back({x, y});
      }
    }
    return places;
  }
  static std::vector<Place> people() {
    constexpr int kPlaces = 16;
    std::vector<Place> places;
    places.reserve(kPlaces);
    for (int i = 0; i < kPlaces; ++i) {
      places.push_back({0.95 * std::sin(2.4 * i), 0.75 * std::sin(1.7 * i + 0.5)});
    }
    return places;
  }
  // Rows of a person at rest at each place, and of a person who walks.
  static std::string survey_rows(double begin,
                                 const std::vector<Place>& places,
                                 const std::string& z) {
    std::string rows = "t_start,t_end,x,y,z\n";
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double t = begin + 3.0 * static_cast<double>(i);
      rows += std::to_string(t) + "," + std::to_string(t + 0.5) + "," +
              std::to_string(places[i].x) + "," + std::to_string(places[i].y) + "," + z + "\n";
    }
    return rows;
  }
  static std::string walked(double begin, double step, int count, double speed) {
    std::string rows = "t,x,y,z\n";
    for (int i = 0; i < count; ++i) {
      rows += std::to_string(begin + step * i) + "," + std::to_string(-0.3 + speed * step * i) +
              ",0.2,0\n";
    }
    return rows;
  }

  static std::string folder() {
    return ::testing::TempDir() + "/train_places_" + std::to_string(::getpid());
  }
  static std::string path(const std::string& name) { return folder() + "/" + name; }
  static std::string capture(int ap, const std::string& name) {
    const std::string id = "ap" + std::to_string(ap);
    return id + "=" + path(name + "-" + id + ".pcap");
  }
  static Finished rayloc(const std::vector<std::string>& arguments) {
    return RaylocProcess(arguments).wait();
  }
  static void run(const std::vector<std::string>& arguments) {
    const Finished finished = rayloc(arguments);
    ASSERT_EQ(finished.status, 0) << finished.err;
  }
  static void simulate(const std::string& name,
                       const std::string& rows,
                       const std::vector<std::string>& more) {
    std::ofstream(path(name + ".csv")) << rows;
    std::vector<std::string> arguments = {"simulate",
                                          path("site"),
                                          "--quiet",
                                          "--seed",
                                          "5",
                                          "--points",
                                          path(name + ".csv"),
                                          "--out",
                                          capture(1, name),
                                          capture(2, name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    run(arguments);
  }
  static std::vector<std::string> train_arguments(const std::string& method,
                                                  const std::string& out,
                                                  const std::vector<std::string>& more) {
    const std::string survey = method == "dscp" ? "people" : "survey";
    std::vector<std::string> arguments = {"train",
                                          path(method == "dscp" ? "reference" : "calibrated"),
                                          "--method",
                                          method,
                                          "--capture",
                                          capture(1, survey),
                                          capture(2, survey),
                                          "--points",
                                          path(survey + ".csv"),
                                          "--out",
                                          path(out)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  static Finished train(const std::string& method,
                        const std::string& out,
                        const std::vector<std::string>& more) {
    return rayloc(train_arguments(method, out, more));
  }
  static Finished replay(const std::string& site,
                         const std::string& method,
                         const std::string& recording,
                         const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"replay",
                                          path(site),
                                          capture(1, recording),
                                          "--method",
                                          method,
                                          "--kind",
                                          method == "cifi" ? "device" : "person",
                                          "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return rayloc(arguments);
  }
  // The reason for the missing position in each snapshot.
  static std::vector<std::string> reasons(const std::string& lines) {
    std::vector<std::string> all;
    std::istringstream in(lines);
    for (std::string line; std::getline(in, line);) {
      const json location = json::parse(line);
      all.push_back(location["quality"].value("no_fix_reason", ""));
    }
    return all;
  }
};

const std::vector<std::string> kQuick = {"--baseline", "epochs=3", "images=2"};

TEST_F(TrainPlaces, CifiIsTrainedKeptAndUsed) {
  const Finished trained = train("cifi", "cifi", kQuick);
  ASSERT_EQ(trained.status, 0) << trained.err;
  EXPECT_THAT(trained.err, HasSubstr("ap2: 24 places"));
  EXPECT_THAT(trained.err, HasSubstr("6 points held out: median error"));
  const std::string toml = content(path("cifi") + "/training/cifi.toml");
  EXPECT_THAT(toml, HasSubstr("settings = [\"epochs=3\", \"images=2\"]"));
  EXPECT_THAT(toml, HasSubstr("weights = \"cifi.f32\""));
  EXPECT_FALSE(fs::exists(path("cifi") + "/training/cifi.checkpoint.json")) << "it is done";
  const auto report = json::parse(content(path("cifi") + "/training/cifi-report.json"));
  EXPECT_EQ(report["epochs"].size(), 3U);
  EXPECT_LT(report["epochs"][2].get<double>(), report["epochs"][0].get<double>());
  const Finished located = replay("cifi", "cifi", "survey", {"--burst", "1.2s"});
  ASSERT_EQ(located.status, 0) << located.err;
  EXPECT_THAT(located.out, HasSubstr("\"method\":\"cifi\""));
  EXPECT_THAT(located.out, HasSubstr("\"position\""));
  // A copy takes the weights along.
  const Finished again = rayloc({"reference",
                                 path("cifi"),
                                 "--capture",
                                 capture(1, "empty"),
                                 "--quiet",
                                 "--out",
                                 path("copy")});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(content(path("copy") + "/training/cifi.f32"),
            content(path("cifi") + "/training/cifi.f32"));
}

TEST_F(TrainPlaces, ContinuesAnInterruptedTraining) {
  const std::vector<std::string> more = {"--baseline", "epochs=4", "images=2"};
  const std::string checkpoint = path("broken") + "/training/cifi.checkpoint.json";
  const RaylocProcess process(train_arguments("cifi", "broken", more));
  eventually(std::chrono::seconds(60), [&] { return fs::exists(checkpoint); });
  process.signal(SIGKILL);
  process.wait();
  ASSERT_TRUE(fs::exists(checkpoint));
  ASSERT_FALSE(fs::exists(path("broken") + "/site.toml")) << "it was not done yet";
  EXPECT_EQ(train("cifi", "broken", more).status, 64) << "the folder is not empty";
  std::vector<std::string> resume = more;
  resume.emplace_back("--resume");
  const Finished other = train("cifi", "broken", {"--baseline", "epochs=9", "--resume"});
  EXPECT_EQ(other.status, 65);
  EXPECT_THAT(other.err,
              HasSubstr("cifi.checkpoint.json: was begun with another site, survey, seed or "
                        "settings; train without --resume"));
  const Finished resumed = train("cifi", "broken", resume);
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  ASSERT_EQ(train("cifi", "whole", more).status, 0);
  EXPECT_EQ(content(path("broken") + "/training/cifi.toml"),
            content(path("whole") + "/training/cifi.toml"));
  EXPECT_EQ(content(path("broken") + "/training/cifi.f32"),
            content(path("whole") + "/training/cifi.f32"));
  EXPECT_THAT(train("cifi", "whole", resume).err, HasSubstr("there is nothing to go on with"));
}

TEST_F(TrainPlaces, RefusesABrokenOrMissingTraining) {
  const Finished without = replay("calibrated", "cifi", "survey");
  EXPECT_EQ(without.status, 78);
  EXPECT_THAT(without.err,
              HasSubstr("site.toml: no training of cifi: run rayloc train " + path("calibrated") +
                        " --method cifi --capture ... --points ..."));
  EXPECT_THAT(replay("reference", "dscp", "people").err, HasSubstr("no training of dscp"));
  ASSERT_EQ(train("cifi", "weights", kQuick).status, 0);
  const std::string file = path("weights") + "/training/cifi.f32";
  const std::string good = content(file);
  const auto refused_with = [&](const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
    const Finished finished = replay("weights", "cifi", "survey");
    EXPECT_EQ(finished.status, 78);
    return finished.err;
  };
  EXPECT_THAT(refused_with(good.substr(0, good.size() - 4)),
              HasSubstr("cifi.f32: states " + std::to_string(good.size() / 4 - 3) +
                        " weights and has bytes for " + std::to_string(good.size() / 4 - 4) +
                        ": train again (rayloc train)"));
  EXPECT_THAT(refused_with("nonsense"), HasSubstr("no file of weights"));
  std::string other = good;
  other[13] = static_cast<char>(other[13] ^ 1);
  EXPECT_THAT(refused_with(other), HasSubstr("holds other weights than were trained"));
  std::ofstream(file, std::ios::binary) << good;
  const Finished aoa = replay("weights", "cifi", "survey", {"--baseline", "input=aoa"});
  EXPECT_EQ(aoa.status, 64);
  EXPECT_THAT(aoa.err, HasSubstr("trained with input=phase; leave it out, or train again"));
  EXPECT_THAT(train("cifi", "nowhere", {"--empty", capture(1, "empty")}).err,
              HasSubstr("--empty is of methods that locate people; leave it out"));
  const std::string training = path("weights") + "/training/cifi.toml";
  const std::string text = content(training);
  const auto refused_after = [&](const std::string& from, const std::string& to) {
    std::string edited = text;
    edited.replace(edited.find(from), from.size(), to);
    std::ofstream(training) << edited;
    const Finished finished = replay("weights", "cifi", "survey");
    EXPECT_EQ(finished.status, 78);
    return finished.err;
  };
  EXPECT_THAT(refused_after("bandwidth_mhz = 40", "bandwidth_mhz = 80"),
              HasSubstr("trained at 80 MHz"));
  EXPECT_THAT(refused_after("calibration = \"", "calibration = \"0"),
              HasSubstr("trained with calibration 0"));
  EXPECT_THAT(refused_after("format = 1", "format = 2"), HasSubstr("format 2 is not known"));
}

TEST_F(TrainPlaces, DscpLearnsFromPeople) {
  const Finished trained = train(
      "dscp",
      "dscp",
      {"--baseline", "epochs=3", "images=2", "--empty", capture(1, "empty"), capture(2, "empty")});
  ASSERT_EQ(trained.status, 0) << trained.err;
  const std::string toml = content(path("dscp") + "/training/dscp.toml");
  EXPECT_THAT(toml, HasSubstr("transmitter = \"02:52:4c:00:00:09\""));
  EXPECT_THAT(toml, HasSubstr("knows_nobody = true"));
  const Finished located = replay("dscp", "dscp", "people", {"--burst", "1.2s"});
  ASSERT_EQ(located.status, 0) << located.err;
  EXPECT_THAT(located.out, HasSubstr("\"method\":\"dscp\""));
  const Finished device = rayloc(
      {"replay", path("dscp"), capture(1, "survey"), "--method", "dscp", "--kind", "device"});
  EXPECT_EQ(device.status, 64);
  EXPECT_THAT(device.err, HasSubstr("--method dscp locates people; use --kind person"));
  const Finished wrong = rayloc({"train",
                                 path("reference"),
                                 "--method",
                                 "dscp",
                                 "--capture",
                                 capture(1, "survey"),
                                 "--points",
                                 path("survey.csv"),
                                 "--out",
                                 path("nowhere")});
  EXPECT_EQ(wrong.status, 65);
  EXPECT_THAT(wrong.err,
              HasSubstr("no fixed transmitter of the site is received at the time of any"));
  const Finished full = train("dscp", "nowhere", {"--empty", capture(1, "survey")});
  EXPECT_EQ(full.status, 65);
  EXPECT_THAT(full.err, HasSubstr("--empty: does not hold 02:52:4c:00:00:09"));
  std::string other = toml;
  other.replace(other.find("4c:00:00:09"), 11, "4c:00:00:08");
  std::ofstream(path("dscp") + "/training/dscp.toml") << other;
  const Finished others = replay("dscp", "dscp", "people", {"--burst", "1.2s"});
  ASSERT_EQ(others.status, 0) << others.err;
  EXPECT_THAT(reasons(others.out),
              AllOf(Not(IsEmpty()),
                    Each(HasSubstr("dscp was trained with 02:52:4c:00:00:08 as the sender"))));
}

TEST_F(TrainPlaces, MethodsForWalkersRefuseMissingInputs) {
  const Finished start = replay("reference", "witraj", "people");
  EXPECT_EQ(start.status, 64);
  EXPECT_THAT(start.err,
              HasSubstr("--method witraj adds steps to a known start: give --start X,Y"));
  run({"reference",
       path("calibrated"),
       "--capture",
       capture(1, "empty"),
       "--quiet",
       "--out",
       path("one")});
  const Finished one = replay("one", "witraj", "people", {"--start", "0,0"});
  EXPECT_EQ(one.status, 78);
  EXPECT_THAT(one.err,
              HasSubstr("witraj needs 2 access points that receive one transmitter, 3 to drop the "
                        "worst; the site has ap1"));
  simulate("slow", walked(5000.0, 0.02, 110, 0.3), {"--transmitter", "plug", "--person"});
  const Finished slow = replay("reference", "widar2", "slow");
  ASSERT_EQ(slow.status, 0) << slow.err;
  EXPECT_THAT(reasons(slow.out),
              ::testing::Contains(HasSubstr("50 frames/s of 02:52:4c:00:00:09 at ap1: widar2 needs "
                                            "104 (4 v_max / wavelength); send more often")));
  const Finished slow_witraj = rayloc({"replay",
                                       path("reference"),
                                       capture(1, "slow"),
                                       capture(2, "slow"),
                                       "--method",
                                       "witraj",
                                       "--start",
                                       "0,0",
                                       "--kind",
                                       "person",
                                       "--quiet"});
  EXPECT_THAT(reasons(slow_witraj.out),
              ::testing::Contains(HasSubstr("50 frames/s of 02:52:4c:00:00:09 at ap1: witraj needs "
                                            "182")));
  simulate("still", walked(6000.0, 0.008, 400, 0.0), {"--transmitter", "plug", "--person"});
  const Finished still = replay("reference", "widar2", "still");
  EXPECT_THAT(reasons(still.out),
              ::testing::Contains(std::string("nothing moves: widar2 sees only what moves")));
}

}  // namespace
}  // namespace rayloc::train_places_test
