// Zones with real processes: the bundled walk through the meeting room, replayed and live.
#include <cmath>
#include <ctime>
#include <fstream>
#include <iomanip>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"

namespace rayloc::e2e::zones_test {
namespace {

using nlohmann::json;

constexpr std::chrono::seconds kPatience{120};
constexpr double kBorder = -0.5;  // [m]; west of it the zone lies

// The calibrated site with a zone in the west of the room, and a place on the Earth.
std::filesystem::path site_with_zone(const std::filesystem::path& folder) {
  std::filesystem::path site = calibrated_site(folder);
  std::ofstream toml(site / "site.toml", std::ios::app);
  toml << "\n[georeference]\nlatitude = 52.52\nlongitude = 13.405\nrotation_deg = 30\n"
       << "[[zone]]\nname = \"west\"\npolygon = [[-1.7, -1.4], [" << kBorder << ", -1.4], ["
       << kBorder << ", 1.4], [-1.7, 1.4]]\ndwell_after_s = 2\n";
  return site;
}

// When the device crossed the border, from the recording's truth [s since 1970].
std::vector<double> crossings() {
  std::vector<double> times;
  const std::vector<std::string> lines = read_lines(bundled("walk.csv"));
  double before = 0.0;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    std::istringstream fields(lines[i]);
    double time = 0.0;
    double x = 0.0;
    char comma = 0;
    fields >> time >> comma >> x;
    if (i > 1 && (before < kBorder) != (x < kBorder)) {
      times.push_back(time);
    }
    before = x;
  }
  return times;
}

// The seconds since 1970 of a time stamp of the recording, "2024-06-10T06:35:55.123Z".
double seconds_of(const std::string& time) {
  std::tm parts{};
  std::istringstream text(time);
  text >> std::get_time(&parts, "%Y-%m-%dT%H:%M:%S");
  double fraction = 0.0;
  if (text.peek() == '.') {
    text >> fraction;
  }
  return static_cast<double>(timegm(&parts)) + fraction;
}

std::string kind_of(const json& event) {
  return event.at("kind").get<std::string>().substr(std::string("ZONE_EVENT_KIND_").size());
}

struct Replayed {
  std::vector<json> locations;
  std::vector<std::string> events;  // lines
};

Replayed replay(const std::filesystem::path& folder,
                const std::filesystem::path& site,
                const std::string& threads) {
  const std::string events = (folder / ("events-" + threads)).string();
  std::vector<std::string> arguments = {
      "replay", site.string(), "--zone-events", events, "--threads", threads};
  for (const std::string access_point : {"ap1", "ap2", "ap3"}) {
    arguments.push_back(access_point + "=" + bundled_recording("walk", access_point));
  }
  Process process(folder, "replay-" + threads, "rayloc", arguments);
  EXPECT_EQ(process.wait(kPatience), 0) << process.errors();
  Replayed replayed;
  for (const std::string& line : read_lines(process.out())) {
    replayed.locations.push_back(json::parse(line));
  }
  replayed.events = read_lines(events);
  return replayed;
}

TEST(Zones, MatchTheTruthOfAReplayedWalk) {
  const TemporaryFolder folder;
  const std::filesystem::path site = site_with_zone(folder.path());
  const Replayed replayed = replay(folder.path(), site, "2");

  const std::vector<double> border = crossings();
  ASSERT_EQ(border.size(), 2U);  // in, out
  ASSERT_EQ(replayed.events.size(), 3U);
  const json entered = json::parse(replayed.events[0]);
  const json dwelled = json::parse(replayed.events[1]);
  const json left = json::parse(replayed.events[2]);
  EXPECT_EQ(kind_of(entered), "ENTERED");
  EXPECT_EQ(kind_of(dwelled), "DWELLED");
  EXPECT_EQ(kind_of(left), "LEFT");
  EXPECT_EQ(entered.at("zone"), "west");
  EXPECT_EQ(entered.at("target").at("mac"), "02:52:4c:00:00:01");
  EXPECT_EQ(entered.at("occupancy"), 1);
  EXPECT_EQ(left.at("inside").size(), 0U);
  EXPECT_EQ(left.at("reason"), "its probability was at most 0.3 for 1 s");
  // Decided half a second after it enters and a second after it leaves, and at most 0.6 s later: a
  // walker of 0.6 m/s first reaches a place that is certain, and then the next frame arrives.
  EXPECT_GE(seconds_of(entered.at("time")), border[0] + 0.3);
  EXPECT_LE(seconds_of(entered.at("time")), border[0] + 1.1);
  EXPECT_GE(seconds_of(left.at("time")), border[1] + 0.8);
  EXPECT_LE(seconds_of(left.at("time")), border[1] + 1.6);

  // The probability of every estimate belongs to its position.
  std::size_t certain = 0;
  for (const json& location : replayed.locations) {
    if (!location.contains("position")) {
      EXPECT_TRUE(location.at("zones").empty());
      continue;
    }
    ASSERT_EQ(location.at("zones").size(), 1U);
    const double inside = location.at("zones").at(0).at("probability").get<double>();
    const double x = location.at("position").at("x").get<double>();
    const double radius = location.at("accuracy_m").get<double>();
    if (std::abs(x - kBorder) > 3.0 * radius) {
      EXPECT_NEAR(inside, x < kBorder ? 1.0 : 0.0, 0.15) << location.dump();
      ++certain;
    }
  }
  EXPECT_GT(certain, replayed.locations.size() / 3);

  EXPECT_EQ(replay(folder.path(), site, "1").events, replayed.events);
}

TEST(Zones, ArePublishedAndSentToLateSubscribers) {
  const TemporaryFolder folder;
  LiveDaemon daemon(folder.path(), {.site = site_with_zone(folder.path())});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  std::vector<std::string> arguments = {"--speed", "1"};
  for (const std::string access_point : {"ap1", "ap2", "ap3"}) {
    arguments.push_back(bundled_recording("walk", access_point));
  }
  ASSERT_EQ(send(folder.path(), "send", daemon, arguments), 0);
  ASSERT_TRUE(eventually(kPatience, [&] {
    const std::vector<json> events = daemon.bodies("zone");
    return !events.empty() && kind_of(events.back()) == "LEFT";
  })) << daemon.errors();
  const std::vector<json> events = daemon.bodies("zone");
  EXPECT_EQ(kind_of(events.front()), "ENTERED");
  for (const json& event : events) {
    EXPECT_EQ(event.at("inside").size(), event.at("occupancy").get<std::size_t>());
  }
  EXPECT_EQ(number(daemon.bodies("heartbeat").back().at("estimation").at("events_dropped")), 0U);

  Process late(folder.path(),
               "late",
               "rayloc",
               {"sub",
                "v1/zone/",
                "--zone",
                "west",
                "--endpoint",
                daemon.endpoint(),
                "--snapshot",
                daemon.snapshot(),
                "--json",
                "--count",
                "1"});
  ASSERT_EQ(late.wait(kPatience), 0) << late.errors();
  EXPECT_EQ(json::parse(read_lines(late.out()).at(0)).at("zone"), events.back());

  Process map(folder.path(),
              "geojson",
              "rayloc",
              {"sub",
               "--format",
               "geojson",
               "--endpoint",
               daemon.endpoint(),
               "--snapshot",
               daemon.snapshot(),
               "--count",
               "1"});
  ASSERT_EQ(map.wait(kPatience), 0) << map.errors();
  const json feature = json::parse(read_lines(map.out()).at(0));
  EXPECT_NEAR(feature.at("geometry").at("coordinates").at(1).get<double>(), 52.52, 1e-4);
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
}

}  // namespace
}  // namespace rayloc::e2e::zones_test
