// A person who carries nothing, as the running daemon finds them: rayloc simulate -> rayloc
// reference -> rayloc send -> raylocd -> rayloc sub.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <future>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"

namespace rayloc::e2e::people_test {
namespace {

constexpr std::array kAccessPoints = {"ap1", "ap2", "ap3"};
const char* const kFixed = "02:52:4c:00:00:02";
constexpr std::chrono::seconds kPatience{240};

struct Place {
  double x;
  double y;
};
constexpr std::array kPlaces = {
    Place{0.9, 0.9}, Place{-0.9, -0.7}, Place{0.9, -0.9}, Place{1.2, 0.4}, Place{-1.0, 0.1}};

class People : public ::testing::Test {
 protected:
  std::filesystem::path folder() const { return folder_.path(); }
  std::string capture(const std::string& name, const std::string& access_point) const {
    return (folder() / (name + "-" + access_point + ".pcap")).string();
  }

  void run(const std::string& name, const std::vector<std::string>& arguments) const {
    Process process(folder(), name, "rayloc", arguments);
    ASSERT_EQ(process.wait(kPatience), 0) << process.errors();
  }

  // The output of `rayloc status`.
  std::string state(const LiveDaemon& daemon) const {
    const std::string address = "127.0.0.1:" + std::to_string(daemon.http_port());
    Process process(folder(), "status", "rayloc", {"status", "--http", address});
    EXPECT_EQ(process.wait(kPatience), 0) << process.errors();
    return read_text(process.out());
  }

  // Simulates the fixed transmitter's frames at all access points, with a person at the points if
  // `more` has the option for it.
  void simulate(const std::string& name,
                const std::vector<std::string>& points,
                const std::vector<std::string>& more) const {
    const std::filesystem::path csv = folder() / (name + ".csv");
    std::ofstream out(csv);
    out << "t_start,t_end,x,y,z\n";
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double begin = 1000.0 + 2.0 * static_cast<double>(i);
      out << begin << ',' << begin + 0.9 << ',' << points[i] << '\n';
    }
    out.close();
    std::vector<std::string> arguments = {"simulate",
                                          (folder() / "calibrated").string(),
                                          "--quiet",
                                          "--transmitter",
                                          kFixed,
                                          "--frames",
                                          "20",
                                          "--points",
                                          csv.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.emplace_back("--out");
    for (const std::string access_point : kAccessPoints) {
      arguments.push_back(access_point + "=" + capture(name, access_point));
    }
    run("simulate-" + name, arguments);
  }

 private:
  const TemporaryFolder folder_;
};

// Every track begins once, goes from state to state and is lost once, if at all; the heartbeat
// counts the same.
void expect_whole_lives(const LiveDaemon& daemon) {
  std::map<std::uint64_t, std::string> state;  // by number
  std::uint64_t lost = 0;
  for (const nlohmann::json& event : daemon.bodies("track")) {
    EXPECT_EQ(event.at("target").at("kind"), "TARGET_KIND_PERSON") << event.dump();
    const auto [track, begins] =
        state.try_emplace(number(event.at("target").at("track")), "TRACK_STATE_UNSPECIFIED");
    EXPECT_EQ(event.at("previous_state"), track->second) << event.dump();
    EXPECT_EQ(event.at("state") == "TRACK_STATE_TENTATIVE", begins) << event.dump();
    track->second = event.at("state");
    lost += track->second == "TRACK_STATE_LOST" ? 1U : 0U;
  }
  EXPECT_GE(state.size(), 1U) << daemon.errors();
  const nlohmann::json tracker = daemon.bodies("heartbeat").back().at("person_tracker");
  EXPECT_EQ(number(tracker.at("begun")), state.size());
  EXPECT_EQ(number(tracker.at("lost")), lost);
  EXPECT_EQ(number(tracker.at("tracks")), state.size() - lost);
  EXPECT_GE(number(tracker.at("used")), kPlaces.size());
  EXPECT_EQ(number(tracker.at("moments")),
            number(tracker.at("used")) + number(tracker.at("nobody")) +
                number(tracker.at("unexplained")) + number(tracker.at("out_of_order")) +
                number(tracker.at("unusable")));
}

TEST_F(People, AreFoundByTheDaemonAndPublished) {
  calibrated_site(folder());
  simulate("empty", {"1.25,-0.45,1.2"}, {});
  std::vector<std::string> places;
  places.reserve(kPlaces.size());
  for (const Place& place : kPlaces) {
    places.push_back(std::to_string(place.x) + "," + std::to_string(place.y) + ",0");
  }
  simulate("people", places, {"--person"});
  std::vector<std::string> arguments = {"reference", (folder() / "calibrated").string(), "--quiet"};
  arguments.emplace_back("--capture");
  for (const std::string access_point : kAccessPoints) {
    arguments.push_back(access_point + "=" + capture("empty", access_point));
  }
  arguments.insert(arguments.end(), {"--out", (folder() / "site").string()});
  run("reference", arguments);

  LiveDaemon daemon(folder(), {.site = folder() / "site"});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  EXPECT_THAT(state(daemon), ::testing::HasSubstr(", 0 tracks of devices, 0 of people; "));
  arguments.clear();
  for (const std::string access_point : kAccessPoints) {
    arguments.push_back(capture("people", access_point));
  }
  auto sent =
      std::async(std::launch::async, [&] { return send(folder(), "send", daemon, arguments); });
  const auto is_located = [&] {
    return state(daemon).find(", 0 of people; ") == std::string::npos;
  };
  EXPECT_TRUE(eventually(kPatience, is_located)) << daemon.errors();
  ASSERT_EQ(sent.get(), 0);
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();

  std::size_t snapshots = 0;
  std::size_t filtered = 0;
  std::array<double, kPlaces.size()> nearest;
  nearest.fill(std::numeric_limits<double>::infinity());
  for (const nlohmann::json& location : daemon.bodies("location")) {
    if (location.at("target").at("kind") != "TARGET_KIND_PERSON") {
      continue;
    }
    EXPECT_FALSE(location.at("target").contains("mac")) << location.dump();
    const bool snapshot = location.at("kind") == "LOCATION_KIND_SNAPSHOT";
    (snapshot ? snapshots : filtered) += 1;
    if (snapshot && location.contains("position")) {
      for (std::size_t i = 0; i < kPlaces.size(); ++i) {
        nearest[i] = std::min(nearest[i],
                              std::hypot(location["position"]["x"].get<double>() - kPlaces[i].x,
                                         location["position"]["y"].get<double>() - kPlaces[i].y));
      }
    }
  }
  EXPECT_GE(snapshots, kPlaces.size()) << daemon.errors();
  EXPECT_GE(filtered, kPlaces.size()) << daemon.errors();
  EXPECT_GE(std::count_if(
                nearest.begin(), nearest.end(), [](double distance) { return distance < 0.15; }),
            4);
  expect_whole_lives(daemon);
}

}  // namespace
}  // namespace rayloc::e2e::people_test
