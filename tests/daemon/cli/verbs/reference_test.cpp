// Tests `rayloc reference` and `rayloc replay --kind person` as processes against the ground truth
// of `rayloc simulate`.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/closet_plan.h"
#include "tests/support/rayloc_process.h"

namespace rayloc::reference_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

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
constexpr const char* kHeader = "t_start,t_end,x,y,z\n";

struct Place {
  double x = 0.0;
  double y = 0.0;
};

class ReferenceVerb : public ::testing::Test {
 protected:
  // The room, two access points, and a calibration of their chains.
  static void SetUpTestSuite() {
    fs::remove_all(folder());
    fs::create_directories(folder());
    const std::string plan =
        test::closet_plan() + test::closet_access_point("ap2", "[1.3, 1.0, 1.2]", -142);
    write("plan.toml", plan);
    run({"scene", "room", path("plan.toml"), "--out", path("site"), "--quiet"});
    std::ofstream(path("site") + "/site.toml", std::ios::app) << kTransmitters;
    std::vector<Place> survey;
    survey.reserve(30);
    for (int row = 0; row < 5; ++row) {
      for (int column = 0; column < 6; ++column) {
        survey.push_back({-1.05 + 0.4 * column, -0.75 + 0.3 * row});
      }
    }
    simulate("survey", 1000.0, survey, "1.2", {});
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
    simulate("empty", 2000.0, {{1.2, -0.6}}, "1.1", {"--transmitter", "plug"});
    simulate("people", 3000.0, people(), "0", {"--transmitter", "plug", "--person"});
    simulate("later", 4000.0, later(), "0", {"--transmitter", "plug", "--person"});
  }
  static void TearDownTestSuite() { fs::remove_all(folder()); }

  static std::vector<Place> people() {
    std::vector<Place> places;
    places.reserve(16);
    for (int i = 0; i < 16; ++i) {
      places.push_back({0.95 * std::sin(2.4 * i), 0.75 * std::sin(1.7 * i + 0.5)});
    }
    return places;
  }
  static std::vector<Place> later() {
    std::vector<Place> places;
    places.reserve(10);
    for (int i = 0; i < 10; ++i) {
      places.push_back({0.9 * std::sin(1.9 * i + 1.0), 0.7 * std::sin(2.9 * i)});
    }
    return places;
  }

  // The folder of this process: other processes run tests of this file at the same time.
  static fs::path folder() {
    return fs::path(::testing::TempDir()) / ("reference_verb_" + std::to_string(::getpid()));
  }
  static std::string path(const std::string& name) { return folder() / name; }
  static std::string capture(int ap, const std::string& name) {
    const std::string id = "ap" + std::to_string(ap);
    return id + "=" + path(name + "-" + id + ".pcap");
  }
  static void write(const std::string& name, const std::string& text) {
    std::ofstream(path(name)) << text;
  }
  static Finished rayloc(const std::vector<std::string>& arguments) {
    return RaylocProcess(arguments).wait();
  }
  static std::string run(const std::vector<std::string>& arguments) {
    const Finished finished = rayloc(arguments);
    EXPECT_EQ(finished.status, 0) << finished.err;
    return finished.out;
  }
  static void simulate(const std::string& name,
                       double begin,
                       const std::vector<Place>& places,
                       const std::string& z,
                       const std::vector<std::string>& more,
                       const std::string& power_cycle = "5") {
    std::string points = kHeader;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double t = begin + 3.0 * static_cast<double>(i);
      points += std::to_string(t) + "," + std::to_string(t + 0.5) + "," +
                std::to_string(places[i].x) + "," + std::to_string(places[i].y) + "," + z + "\n";
    }
    write(name + ".csv", points);
    std::vector<std::string> arguments = {"simulate",
                                          path("site"),
                                          "--quiet",
                                          "--seed",
                                          power_cycle,
                                          "--points",
                                          path(name + ".csv"),
                                          "--out",
                                          capture(1, name),
                                          capture(2, name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    run(arguments);
  }
  static std::vector<json> replay(const std::string& site, const std::string& name) {
    std::istringstream lines(run({"replay",
                                  path(site),
                                  capture(1, name),
                                  capture(2, name),
                                  "--kind",
                                  "person",
                                  "--burst",
                                  "1.2s",
                                  "--quiet"}));
    std::vector<json> snapshots;
    for (std::string line; std::getline(lines, line);) {
      json location = json::parse(line);
      if (location["kind"] == "LOCATION_KIND_SNAPSHOT") {
        snapshots.push_back(std::move(location));
      }
    }
    return snapshots;
  }
  static double error_of(const json& snapshot, const Place& truth) {
    if (!snapshot.contains("position")) {
      return std::numeric_limits<double>::infinity();
    }
    const double x = snapshot["position"]["x"];
    const double y = snapshot["position"]["y"];
    return std::hypot(x - truth.x, y - truth.y);
  }
  // The number of snapshots within 15 cm of the truth.
  static int near(const std::vector<json>& snapshots, const std::vector<Place>& truth) {
    int count = 0;
    for (std::size_t i = 0; i < std::min(snapshots.size(), truth.size()); ++i) {
      count += error_of(snapshots[i], truth[i]) < 0.15 ? 1 : 0;
    }
    return count;
  }
  // The number of snapshots within their stated accuracy.
  static int within_accuracy(const std::vector<json>& snapshots, const std::vector<Place>& truth) {
    int count = 0;
    for (std::size_t i = 0; i < std::min(snapshots.size(), truth.size()); ++i) {
      const bool stated = snapshots[i].contains("accuracy_m");
      count += stated && error_of(snapshots[i], truth[i]) <= snapshots[i]["accuracy_m"] ? 1 : 0;
    }
    return count;
  }
};

// After a power cycle the chains are new and the empty room is unchanged: the fixed transmitter and
// its reference give the chains, and people are located against the reference as before.
TEST_F(ReferenceVerb, SurvivesAPowerCycle) {
  run({"reference",
       path("calibrated"),
       "--quiet",
       "--capture",
       capture(1, "empty"),
       capture(2, "empty"),
       "--out",
       path("before")});
  simulate("again", 6000.0, {{1.2, -0.6}}, "1.1", {"--transmitter", "plug"}, "6");
  simulate("visit", 7000.0, later(), "0", {"--transmitter", "plug", "--person"}, "6");
  run({"calibrate",
       path("before"),
       "--rechain",
       "--quiet",
       "--capture",
       capture(1, "again"),
       capture(2, "again"),
       "--out",
       path("after")});
  std::ifstream in(path("after") + "/report.json");
  for (const json& access_point : json::parse(in)["access_points"]) {
    EXPECT_GT(access_point["fit"].get<double>(), 0.99);
  }
  const std::vector<json> usual = replay("before", "later");
  const std::vector<json> renewed = replay("after", "visit");
  // Some of these places look alike: other noise may rank the other of two likely places first.
  for (const std::vector<json>& snapshots : {usual, renewed}) {
    EXPECT_GE(near(snapshots, later()), 4);
    EXPECT_GE(within_accuracy(snapshots, later()), 9);
  }
  EXPECT_LE(near(replay("before", "visit"), later()), 1);
}

TEST_F(ReferenceVerb, LeadsFromTheEmptyRoomToPlacesOfPeople) {
  const Finished learned = rayloc({"reference",
                                   path("calibrated"),
                                   "--capture",
                                   capture(1, "empty"),
                                   capture(2, "empty"),
                                   "--people",
                                   capture(1, "people"),
                                   capture(2, "people"),
                                   "--points",
                                   path("people.csv"),
                                   "--out",
                                   path("people-site")});
  ASSERT_EQ(learned.status, 0) << learned.err;
  EXPECT_THAT(learned.err, HasSubstr("person from 16 places"));
  const auto snapshots = replay("people-site", "later");
  const auto truth = later();
  ASSERT_EQ(snapshots.size(), truth.size());
  // Half a second at the first place may be too short to confirm a track that outlives the gap.
  for (const json& snapshot : snapshots) {
    EXPECT_EQ(snapshot["target"]["kind"], "TARGET_KIND_PERSON");
    EXPECT_TRUE(snapshot == snapshots.front() ||
                snapshot["target"]["track"] == snapshots.back()["target"]["track"]);
  }
  EXPECT_GE(near(snapshots, truth), 7);
  EXPECT_GE(within_accuracy(snapshots, truth), 9);

  // No person is detected in the empty room.
  for (const json& location : replay("people-site", "empty")) {
    EXPECT_EQ(location["mode"], "FIX_MODE_NO_FIX");
    EXPECT_THAT(location["quality"]["no_fix_reason"].get<std::string>(), HasSubstr("no person"));
  }
}

// People of the first day, and the empty room of each: chains have rotated in between.
TEST_F(ReferenceVerb, UsesPeopleOfAnotherDay) {
  simulate("today", 8000.0, {{1.2, -0.6}}, "1.1", {"--transmitter", "plug"}, "7");
  simulate("guests", 9000.0, later(), "0", {"--transmitter", "plug", "--person"}, "7");
  const Finished learned = rayloc({"reference",
                                   path("calibrated"),
                                   "--capture",
                                   capture(1, "today"),
                                   capture(2, "today"),
                                   "--people",
                                   capture(1, "people"),
                                   capture(2, "people"),
                                   "--people-empty",
                                   capture(1, "empty"),
                                   capture(2, "empty"),
                                   "--points",
                                   path("people.csv"),
                                   "--out",
                                   path("another-day")});
  ASSERT_EQ(learned.status, 0) << learned.err;
  EXPECT_THAT(learned.err, HasSubstr("person from 16 places"));
  EXPECT_THAT(learned.err, HasSubstr("ap1: since people were recorded: core"));
  EXPECT_THAT(learned.err, HasSubstr("today's gains are written"));
  const std::vector<json> found = replay("another-day", "guests");
  EXPECT_GE(near(found, later()), 5);
  EXPECT_GE(within_accuracy(found, later()), 8);
  for (const json& location : replay("another-day", "today")) {
    EXPECT_THAT(location["quality"]["no_fix_reason"].get<std::string>(), HasSubstr("no person"));
  }
}

// The same without the empty room of the first day. People of the same day are accepted
// (LeadsFromTheEmptyRoomToPlacesOfPeople).
TEST_F(ReferenceVerb, RefusesPeopleOfAnotherDayWithoutTheirEmptyRoom) {
  simulate("tomorrow", 8000.0, {{1.2, -0.6}}, "1.1", {"--transmitter", "plug"}, "7");
  const Finished refused = rayloc({"reference",
                                   path("calibrated"),
                                   "--capture",
                                   capture(1, "tomorrow"),
                                   capture(2, "tomorrow"),
                                   "--people",
                                   capture(1, "people"),
                                   capture(2, "people"),
                                   "--points",
                                   path("people.csv"),
                                   "--out",
                                   path("one-day")});
  EXPECT_EQ(refused.status, 65);
  EXPECT_THAT(refused.err, HasSubstr("other chain phases than --capture (ap1: rx chain "));
  EXPECT_THAT(refused.err, HasSubstr("--people-empty [AP=]FILE"));
  EXPECT_FALSE(fs::exists(path("one-day")));
}

TEST_F(ReferenceVerb, RefusesADayThatIsNone) {
  const auto refused = [](const std::vector<std::string>& more) {
    std::vector<std::string> all = {
        "reference", path("calibrated"), "--capture", capture(1, "empty")};
    all.insert(all.end(), more.begin(), more.end());
    all.insert(all.end(), {"--out", path("no-day")});
    return rayloc(all);
  };
  const Finished empty_room = refused({"--people-empty", capture(1, "empty")});
  EXPECT_EQ(empty_room.status, 64);
  EXPECT_THAT(empty_room.err, HasSubstr("--people-empty"));
  const std::vector<std::string> people = {
      "--people", capture(1, "people"), "--points", path("people.csv"), "--people-empty"};
  const auto with = [&](const std::string& file) {
    std::vector<std::string> all = people;
    all.push_back(file);
    return refused(all);
  };
  const Finished device = with(capture(1, "survey"));
  EXPECT_EQ(device.status, 65);
  EXPECT_THAT(device.err, HasSubstr("no fixed transmitter"));
  const Finished moving = with(capture(1, "people"));
  EXPECT_EQ(moving.status, 65);
  EXPECT_THAT(moving.err, HasSubstr("--people-empty: access point ap1: the channel"));
  const Finished other = with("ap1=" + path("empty-ap2.pcap"));
  EXPECT_EQ(other.status, 65) << other.err;
  EXPECT_THAT(other.err, HasSubstr("too little in common"));
  EXPECT_FALSE(fs::exists(path("no-day")));
}

TEST_F(ReferenceVerb, ReportsThatPeopleNeedAReference) {
  const auto snapshots = replay("calibrated", "later");
  ASSERT_FALSE(snapshots.empty());
  EXPECT_EQ(snapshots[0]["mode"], "FIX_MODE_NO_FIX");
  EXPECT_THAT(snapshots[0]["quality"]["no_fix_reason"].get<std::string>(),
              HasSubstr("rayloc reference"));
}

TEST_F(ReferenceVerb, RefusesUnusableRecordings) {
  const auto refused = [](const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {"reference"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.insert(all.end(), {"--out", path("refused")});
    return rayloc(all);
  };
  const Finished plan = refused({path("site"), "--capture", capture(1, "empty")});
  EXPECT_EQ(plan.status, 78);
  EXPECT_THAT(plan.err, HasSubstr("rayloc calibrate"));
  const Finished device = refused({path("calibrated"), "--capture", capture(1, "survey")});
  EXPECT_EQ(device.status, 65);
  EXPECT_THAT(device.err, HasSubstr("no fixed transmitter"));
  const Finished alone = refused(
      {path("calibrated"), "--capture", capture(1, "empty"), "--people", capture(1, "people")});
  EXPECT_EQ(alone.status, 64);
  EXPECT_THAT(alone.err, HasSubstr("--points"));
  const Finished moving = refused({path("calibrated"), "--capture", capture(1, "people")});
  EXPECT_EQ(moving.status, 65);
  EXPECT_THAT(moving.err, HasSubstr("changes during the recording"));
  EXPECT_FALSE(fs::exists(path("refused")));
  const Finished itself = rayloc({"reference",
                                  path("calibrated"),
                                  "--capture",
                                  capture(1, "empty"),
                                  "--force",
                                  "--out",
                                  path("calibrated")});
  EXPECT_EQ(itself.status, 64);
  EXPECT_THAT(itself.err, HasSubstr("is the site that is read"));
  EXPECT_FALSE(fs::exists(path("calibrated") + "/reference.toml"));
}

TEST_F(ReferenceVerb, RefusesAReferenceOfAnotherCalibration) {
  run({"reference",
       path("calibrated"),
       "--quiet",
       "--capture",
       capture(1, "empty"),
       "--out",
       path("old")});
  fs::copy(path("old"), path("stale"), fs::copy_options::recursive);
  std::ifstream in(path("stale") + "/reference.toml");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto begin = text.find("calibration = \"") + 15;
  text.replace(begin, 4, "0000");
  write("stale/reference.toml", text);
  const Finished finished =
      rayloc({"replay", path("stale"), capture(1, "later"), "--kind", "person"});
  EXPECT_EQ(finished.status, 78);
  EXPECT_THAT(finished.err, HasSubstr("rayloc reference"));
}

}  // namespace
}  // namespace rayloc::reference_test
