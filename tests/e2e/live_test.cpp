// The whole way with real processes and real sockets: rayloc send -> raylocd -> rayloc sub.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"
#include "tests/e2e/shifted_clock.h"
#include "tests/e2e/stated.h"

namespace rayloc::e2e::live_test {
namespace {

constexpr std::array kAccessPoints = {"ap1", "ap2", "ap3"};
// Eight times the recorded pace: a point lasts 0.13 s, less than a burst, and the shortest way
// between two takes 0.39 s, more than the gap that ends one. So each point is one burst. At a
// slower pace bursts are longer in the same measure.
const double kSpeed = 8.0;
const double kSlowSpeed = kSpeed / slower();
const double kSlowBurst = 0.2 * slower();  // [s]
constexpr std::chrono::seconds kPatience{120};

struct SurveyedPoint {
  double x;
  double y;
};

std::vector<SurveyedPoint> surveyed_points() {
  std::vector<SurveyedPoint> points;
  const std::vector<std::string> lines = read_lines(bundled("device_los.csv"));
  for (std::size_t i = 1; i < lines.size(); ++i) {
    std::istringstream fields(lines[i]);
    std::array<double, 4> value{};
    char comma = 0;
    for (double& v : value) {
      fields >> v >> comma;
    }
    points.push_back({value[2], value[3]});
  }
  return points;
}

// TOML of the slow pace, after the fixture's own.
std::string slow_bursts() { return "[engine]\nburst_s = " + std::to_string(kSlowBurst) + "\n"; }

// Sends the recordings of all access points as one, in their common time; false when that fails.
bool send_recordings(const std::filesystem::path& folder, const LiveDaemon& daemon, double speed) {
  std::vector<std::string> arguments = {"--speed", std::to_string(speed)};
  for (const std::string access_point : kAccessPoints) {
    arguments.push_back(bundled_recording("device_los", access_point));
  }
  return send(folder, "send", daemon, arguments) == 0;
}

double horizontal_error(const nlohmann::json& location, const SurveyedPoint& point) {
  const nlohmann::json& position = location.at("position");
  return std::hypot(position.at("x").get<double>() - point.x,
                    position.at("y").get<double>() - point.y);
}

// The snapshots among the locations, in order.
std::vector<nlohmann::json> snapshots_of(const std::vector<nlohmann::json>& locations) {
  std::vector<nlohmann::json> snapshots;
  std::copy_if(locations.begin(),
               locations.end(),
               std::back_inserter(snapshots),
               [](const nlohmann::json& location) {
                 return location.at("kind") == "LOCATION_KIND_SNAPSHOT";
               });
  return snapshots;
}

// As sorted text: live, a message is sent as soon as its location is computed, and a replay is
// sorted by time.
std::vector<std::string> sorted(const std::vector<nlohmann::json>& locations) {
  std::vector<std::string> texts;
  texts.reserve(locations.size());
  for (const nlohmann::json& location : locations) {
    texts.push_back(location.at("event_id").get<std::string>() + " " + location.dump());
  }
  std::sort(texts.begin(), texts.end());
  return texts;
}

TEST(Live, LocatesEveryPointOfARecordingSentOverUdp) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(),
                    {.site = calibrated_site(folder.path()), .more_configuration = slow_bursts()});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  ASSERT_TRUE(send_recordings(folder.path(), daemon, kSlowSpeed));
  const std::vector<SurveyedPoint> points = surveyed_points();
  eventually(std::chrono::seconds{20},
             [&] { return snapshots_of(daemon.bodies("location")).size() >= points.size(); });
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();

  const std::vector<nlohmann::json> locations = snapshots_of(daemon.bodies("location"));
  ASSERT_EQ(locations.size(), points.size()) << daemon.errors();
  std::vector<double> errors;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(locations[i].at("quality").at("access_points"), 3);
    if (locations[i].at("mode") == "FIX_MODE_NO_FIX") {
      EXPECT_FALSE(locations[i].at("quality").at("no_fix_reason").get<std::string>().empty());
    } else {
      errors.push_back(horizontal_error(locations[i], points[i]));
    }
  }
  // In a room with calibrated gains alone, access points contradict each other at times.
  ASSERT_GE(errors.size(), points.size() - 1);
  std::nth_element(errors.begin(), errors.begin() + 10, errors.end());
  // Always answering the centre of the room has a median error of 1.01 m.
  EXPECT_LT(errors[10], 0.5);
  EXPECT_EQ(daemon.bodies("goodbye").size(), 1U);
}

// How often the first access point has found the machine's clock set, by the last heartbeat.
std::uint64_t clock_steps(const LiveDaemon& daemon) {
  return number(
      daemon.bodies("heartbeat").back().at("sources").at(0).at("counters").at("clock_steps"));
}

TEST(Live, PublishesTrackStatesAndCountsEveryMoment) {
  const TemporaryFolder folder;
  ShiftedClock clock(folder.path());
  LiveDaemon daemon(
      folder.path(),
      {.site = calibrated_site(folder.path()), .setting = {.environment = clock.environment()}});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  // Meanwhile the machine's clock is set: no track is affected.
  std::thread clock_setter([&] {
    EXPECT_TRUE(eventually(kPatience, [&] { return !daemon.bodies("track").empty(); }));
    std::uint64_t steps = 0;
    for (const int hours : {1, -1, 0}) {
      clock.set(std::chrono::hours(hours));
      ++steps;
      EXPECT_TRUE(eventually(kPatience, [&] { return clock_steps(daemon) == steps; }));
    }
  });
  const bool sent = send_recordings(folder.path(), daemon, kSpeed);
  clock_setter.join();
  ASSERT_TRUE(sent);
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();

  const std::vector<nlohmann::json> events = daemon.bodies("track");
  ASSERT_GE(events.size(), 2U) << daemon.errors();
  std::string state = "TRACK_STATE_UNSPECIFIED";
  std::uint64_t begun = 0;
  std::uint64_t lost = 0;
  for (const nlohmann::json& event : events) {
    EXPECT_EQ(event.at("previous_state"), state) << event.dump();
    EXPECT_FALSE(event.at("reason").get<std::string>().empty());
    begun += state == "TRACK_STATE_UNSPECIFIED" ? 1U : 0U;
    EXPECT_EQ(number(event.at("target").at("track")), begun);
    EXPECT_EQ(event.at("target").at("mac"), "02:52:4c:00:00:01");
    state = event.at("state");
    if (state == "TRACK_STATE_LOST") {
      ++lost;
      state = "TRACK_STATE_UNSPECIFIED";
    }
  }
  EXPECT_EQ(events[1].at("state"), "TRACK_STATE_CONFIRMED");

  const nlohmann::json heartbeat = daemon.bodies("heartbeat").back();
  const nlohmann::json& tracker = heartbeat.at("tracker");
  EXPECT_EQ(clock_steps(daemon), 3U);
  EXPECT_EQ(begun, 1U) << "who pauses for a second is the same";
  EXPECT_EQ(number(tracker.at("begun")), begun);
  EXPECT_EQ(number(tracker.at("lost")), lost);
  EXPECT_EQ(number(tracker.at("tracks")), begun - lost);
  // With sanitizers bursts are merged, to one for a point at worst.
  EXPECT_GE(number(tracker.at("used")), surveyed_points().size() + (slower() == 1 ? 1U : 0U));
  EXPECT_EQ(number(tracker.at("moments")),
            number(tracker.at("used")) + number(tracker.at("out_of_order")) +
                number(tracker.at("unusable")) + number(tracker.at("unexplained")));
  const nlohmann::json& estimation = heartbeat.at("estimation");
  EXPECT_EQ(number(estimation.at("events_dropped")), 0U);
  EXPECT_GE(number(estimation.at("filtered")), number(tracker.at("used")));
}

TEST(Live, ReplayOfItsRecordingGivesTheSameMessages) {
  const TemporaryFolder folder;
  const std::filesystem::path recordings = folder.path() / "recordings";
  std::filesystem::create_directory(recordings);
  const std::filesystem::path site = calibrated_site(folder.path());
  LiveDaemon daemon(folder.path(),
                    {.site = site,
                     .more_configuration = slow_bursts() + "[record]\ndirectory = \"" +
                                           recordings.string() + "\"\n"});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  ASSERT_TRUE(send_recordings(folder.path(), daemon, kSlowSpeed));
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();
  const std::vector<nlohmann::json> live = daemon.bodies("location");
  ASSERT_EQ(snapshots_of(live).size(), surveyed_points().size());
  ASSERT_GT(live.size(), 2 * surveyed_points().size());  // the tracker's are among them

  std::vector<std::string> arguments = {"replay", site.string()};
  for (const std::string access_point : kAccessPoints) {
    for (const auto& entry : std::filesystem::directory_iterator(recordings)) {
      if (entry.path().filename().string().find(access_point) != std::string::npos) {
        arguments.push_back(access_point + "=" + entry.path().string());
      }
    }
  }
  ASSERT_EQ(arguments.size(), 2 + kAccessPoints.size());
  for (const auto& [speed, threads] : {std::pair{"max", "1"}, std::pair{"8", "2"}}) {
    std::vector<std::string> words = arguments;
    words.insert(
        words.end(),
        {"--speed", speed, "--threads", threads, "--burst", std::to_string(kSlowBurst) + "s"});
    Process replay(folder.path(), std::string("replay-") + speed, "rayloc", words);
    ASSERT_EQ(replay.wait(kPatience), 0) << replay.errors();
    std::vector<nlohmann::json> replayed;
    for (const std::string& line : read_lines(replay.out())) {
      replayed.push_back(nlohmann::json::parse(line));
    }
    EXPECT_EQ(sorted(replayed), sorted(live)) << "at speed " << speed;
  }
}

}  // namespace
}  // namespace rayloc::e2e::live_test
