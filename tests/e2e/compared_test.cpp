// Several methods at one site with real processes: rayloc send -> raylocd -> rayloc sub.
#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"
#include "tests/e2e/stated.h"

namespace rayloc::e2e::compared_test {
namespace {

using nlohmann::json;
using ::testing::EndsWith;
using ::testing::HasSubstr;

constexpr std::array kAccessPoints = {"ap1", "ap2", "ap3"};
const char* const kDevice = "02:52:4c:00:00:01";
const char* const kFixed = "02:52:4c:00:00:02";
constexpr std::chrono::seconds kPatience{240};
// As in live_test.cpp: each point is one burst.
const double kSpeed = 8.0 / slower();
const double kBurst = 0.2 * slower();  // [s]
const double kSent = 3.0 * slower();   // [s]

class Compared : public ::testing::Test {
 protected:
  std::filesystem::path folder() const { return folder_.path(); }
  void run(const std::string& name, const std::vector<std::string>& arguments) const {
    Process process(folder(), name, "rayloc", arguments);
    ASSERT_EQ(process.wait(kPatience), 0) << process.errors();
  }
  static std::vector<std::string> captures(const std::string& name) {
    std::vector<std::string> files;
    files.reserve(kAccessPoints.size());
    for (const std::string access_point : kAccessPoints) {
      files.push_back(access_point + "=" + bundled_recording(name, access_point));
    }
    return files;
  }
  // The first points of the recordings of all access points as one; false when that fails.
  bool send_device(const LiveDaemon& daemon) const {
    std::vector<std::string> arguments = {
        "--speed", std::to_string(kSpeed), "--duration", std::to_string(kSent)};
    for (const std::string access_point : kAccessPoints) {
      arguments.push_back(bundled_recording("device_los", access_point));
    }
    return send(folder(), "send", daemon, arguments) == 0;
  }
  // Estimates of what raylocd recorded there.
  std::vector<json> replayed(const std::filesystem::path& site,
                             const std::filesystem::path& recordings,
                             const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {
        "replay", site.string(), "--burst", std::to_string(kBurst) + "s"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    for (const std::string access_point : kAccessPoints) {
      for (const auto& entry : std::filesystem::directory_iterator(recordings)) {
        if (entry.path().filename().string().find(access_point) != std::string::npos) {
          arguments.push_back(access_point + "=" + entry.path().string());
        }
      }
    }
    Process replay(folder(), "replay", "rayloc", arguments);
    EXPECT_EQ(replay.wait(kPatience), 0) << replay.errors();
    std::vector<json> estimates;
    for (const std::string& line : read_lines(replay.out())) {
      estimates.push_back(json::parse(line));
    }
    return estimates;
  }
  static std::string engine(const std::string& method) {
    return "[engine]\nburst_s = " + std::to_string(kBurst) + "\nmethod = " + method + "\n";
  }

 private:
  const TemporaryFolder folder_;
};

bool is_located(const json& location) { return location.contains("position"); }

std::size_t located(const std::vector<json>& locations) {
  return static_cast<std::size_t>(std::count_if(locations.begin(), locations.end(), is_located));
}

std::string burst_of(const json& location) {
  return location.at("capture_start").get<std::string>() + " to " +
         location.at("capture_end").get<std::string>();
}

// Counters of the compared methods in the last heartbeat.
json counters_of(const LiveDaemon& daemon) {
  return daemon.bodies("heartbeat").back().at("compared");
}

std::vector<std::string> sorted(const std::vector<json>& locations) {
  std::vector<std::string> texts;
  texts.reserve(locations.size());
  for (const json& location : locations) {
    texts.push_back(location.at("event_id").get<std::string>() + " " + location.dump());
  }
  std::sort(texts.begin(), texts.end());
  return texts;
}

TEST_F(Compared, BothLocateTheDeviceAndTheFirstIsUnchanged) {
  const std::filesystem::path site = calibrated_site(folder());
  const std::filesystem::path recordings = folder() / "recordings";
  std::filesystem::create_directory(recordings);
  LiveDaemon daemon(
      folder(),
      {.site = site,
       .more_configuration = engine(R"(["rayloc", "spotfi"])") + "[record]\ndirectory = \"" +
                             recordings.string() + "\"\n"});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  ASSERT_TRUE(send_device(daemon));
  eventually(kPatience, [&] {
    const json compared = counters_of(daemon);
    return number(compared.at(0).at("bursts")) > 0 &&
           number(compared.at(0).at("bursts_in_flight")) == 0;
  });
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();

  const std::vector<json> first = daemon.bodies("location");
  const std::vector<json> others = daemon.bodies("compared");
  ASSERT_GT(located(first), 0U);
  ASSERT_GT(located(others), 0U) << daemon.errors();
  std::set<std::string> bursts;
  for (const json& location : first) {
    EXPECT_EQ(location.at("quality").at("method"), "rayloc");
    bursts.insert(burst_of(location));
  }
  for (const json& location : others) {
    EXPECT_EQ(location.at("quality").at("method"), "spotfi");
    EXPECT_EQ(location.at("target").at("mac"), kDevice);
    EXPECT_THAT(location.at("event_id").get<std::string>(), EndsWith("-snapshot-spotfi"));
    EXPECT_EQ(bursts.count(burst_of(location)), 1U) << "another burst: " << location.dump();
  }
  const json counters = counters_of(daemon).at(0);
  EXPECT_EQ(counters.at("method"), "spotfi");
  EXPECT_EQ(number(counters.at("fixes")), located(others));
  EXPECT_EQ(number(counters.at("bursts")),
            number(counters.at("bursts_explained")) + number(counters.at("bursts_dropped")) +
                number(counters.at("bursts_in_flight")));

  EXPECT_EQ(sorted(replayed(site, recordings, {})), sorted(first)) << "of rayloc alone";
}

TEST_F(Compared, SpotfiAloneIsTheMethodOfTheSite) {
  LiveDaemon daemon(
      folder(), {.site = calibrated_site(folder()), .more_configuration = engine("\"spotfi\"")});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  ASSERT_TRUE(send_device(daemon));
  eventually(kPatience, [&] { return located(daemon.bodies("location")) > 0; });
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();
  EXPECT_GT(located(daemon.bodies("location")), 0U);
  for (const json& location : daemon.bodies("location")) {
    EXPECT_EQ(location.at("quality").at("method"), "spotfi");
  }
  EXPECT_TRUE(daemon.bodies("compared").empty());
  EXPECT_TRUE(counters_of(daemon).empty());
}

// A device that hops over four channels of 40 MHz, and a site calibrated on one of them.
TEST_F(Compared, M3LocatesADeviceThatHopsAsAReplayDoes) {
  const std::filesystem::path site = calibrated_site(folder());
  const std::filesystem::path recordings = folder() / "recordings";
  std::filesystem::create_directory(recordings);
  std::ofstream(folder() / "places.csv") << "t_start,t_end,x,y,z\n"
                                            "1000,1000.1,0.5,0.5,1.2\n"
                                            "1001,1001.1,-0.4,-0.3,1.2\n";
  std::ofstream(folder() / "radio.toml") << "retry_share = 0\n";
  std::vector<std::string> simulate = {"simulate",
                                       site.string(),
                                       "--quiet",
                                       "--points",
                                       (folder() / "places.csv").string(),
                                       "--channels",
                                       "36-64",
                                       "--frames",
                                       "8",
                                       "--impairments",
                                       (folder() / "radio.toml").string(),
                                       "--out"};
  std::vector<std::string> files;
  for (const std::string access_point : kAccessPoints) {
    files.push_back((folder() / ("hops-" + access_point + ".pcap")).string());
    simulate.push_back(access_point + "=" + files.back());
  }
  run("simulate", simulate);
  LiveDaemon daemon(folder(),
                    {.site = site,
                     .more_configuration = engine("\"m3\"") + "[record]\ndirectory = \"" +
                                           recordings.string() + "\"\n"});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  files.insert(files.begin(), {"--speed", std::to_string(1.0 / slower())});
  ASSERT_EQ(send(folder(), "send", daemon, files), 0);
  EXPECT_TRUE(eventually(kPatience, [&] { return daemon.bodies("location").size() == 2; }));
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();

  const std::vector<json> live = daemon.bodies("location");
  EXPECT_EQ(located(live), 2U);
  for (const json& location : live) {
    EXPECT_EQ(location.at("quality").at("method"), "m3");
    EXPECT_EQ(location.at("quality").at("frames"), 24) << location;
    EXPECT_THAT(location.at("quality").at("warnings").dump(), HasSubstr("hops over 4 channels"));
  }
  EXPECT_EQ(sorted(replayed(site, recordings, {"--method", "m3", "--kind", "device"})),
            sorted(live));
}

TEST_F(Compared, AMethodThatCannotBeMadeEndsTheStartAtItsPlace) {
  const std::filesystem::path site = calibrated_site(folder());
  std::ofstream(site / "cifi.toml") << "nonsense";
  std::ofstream(site / "site.toml", std::ios::app)
      << "\n[[training]]\nmethod = \"cifi\"\nfile = \"cifi.toml\"\n";
  LiveDaemon daemon(
      folder(),
      {.site = site, .more_configuration = "[engine]\nmethod = [\"rayloc\", \"cifi\"]\n"});
  EXPECT_EQ(daemon.wait(kPatience), 78) << daemon.log();
  EXPECT_THAT(daemon.log(), HasSubstr(":21: method 'cifi': "));
  EXPECT_THAT(daemon.log(), HasSubstr("cifi.toml"));
}

TEST_F(Compared, CifiRunsLiveOnceItIsTrained) {
  std::vector<std::string> arguments = {"train",
                                        calibrated_site(folder()).string(),
                                        "--method",
                                        "cifi",
                                        "--quiet",
                                        "--points",
                                        bundled("calibration.csv").string(),
                                        "--out",
                                        (folder() / "site").string(),
                                        "--baseline",
                                        "epochs=2",
                                        "images=2",
                                        "--capture"};
  for (const std::string& file : captures("calibration")) {
    arguments.push_back(file);
  }
  run("train", arguments);
  LiveDaemon daemon(
      folder(),
      {.site = folder() / "site", .more_configuration = engine(R"(["rayloc", "cifi", "spotfi"])")});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  ASSERT_TRUE(send_device(daemon));
  const auto of_cifi = [&] {
    std::vector<json> found = daemon.bodies("compared");
    std::erase_if(found, [](const json& one) { return one.at("quality").at("method") != "cifi"; });
    return found;
  };
  EXPECT_TRUE(eventually(kPatience, [&] { return located(of_cifi()) > 0; })) << daemon.errors();
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();
  for (const json& location : of_cifi()) {
    EXPECT_THAT(location.at("event_id").get<std::string>(), EndsWith("-cifi"));
  }
  EXPECT_EQ(counters_of(daemon).size(), 2U);
}

TEST_F(Compared, DscpRunsLiveOnceItIsTrained) {
  const std::string site = calibrated_site(folder()).string();
  const auto capture = [&](const std::string& name, const std::string& access_point) {
    return (folder() / (name + "-" + access_point + ".pcap")).string();
  };
  const auto all = [&](const std::string& name) {
    std::vector<std::string> files;
    files.reserve(kAccessPoints.size());
    for (const std::string access_point : kAccessPoints) {
      files.push_back(access_point + "=" + capture(name, access_point));
    }
    return files;
  };
  const auto with = [](std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  std::ofstream(folder() / "empty.csv") << "t_start,t_end,x,y,z\n1000,1000.9,1.25,-0.45,1.2\n";
  {
    std::ofstream points(folder() / "people.csv");
    points << "t_start,t_end,x,y,z\n";
    double begin = 1000.0;
    for (const double y : {-0.7, 0.0, 0.7}) {
      for (const double x : {-0.9, -0.3, 0.3, 0.9}) {
        points << begin << ',' << begin + 0.9 << ',' << x << ',' << y << ",0\n";
        begin += 2.0;
      }
    }
  }
  for (const std::string name : {"empty", "people"}) {
    std::vector<std::string> arguments = {"simulate",
                                          site,
                                          "--quiet",
                                          "--transmitter",
                                          kFixed,
                                          "--frames",
                                          "20",
                                          "--points",
                                          (folder() / (name + ".csv")).string()};
    if (name == "people") {
      arguments.emplace_back("--person");
    }
    arguments.emplace_back("--out");
    run("simulate-" + name, with(arguments, all(name)));
  }
  const std::string reference = (folder() / "reference").string();
  run("reference",
      with({"reference", site, "--quiet", "--out", reference, "--capture"}, all("empty")));
  run("train",
      with({"train",
            reference,
            "--method",
            "dscp",
            "--quiet",
            "--points",
            (folder() / "people.csv").string(),
            "--out",
            (folder() / "site").string(),
            "--baseline",
            "epochs=2",
            "images=2",
            "--capture"},
           all("people")));
  LiveDaemon daemon(folder(),
                    {.site = folder() / "site", .more_configuration = engine("\"dscp\"")});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();
  std::vector<std::string> files;
  files.reserve(kAccessPoints.size());
  for (const std::string access_point : kAccessPoints) {
    files.push_back(capture("people", access_point));
  }
  ASSERT_EQ(send(folder(), "send", daemon, files), 0);
  EXPECT_TRUE(eventually(kPatience, [&] { return !daemon.bodies("location").empty(); }));
  ASSERT_EQ(daemon.stop(), 0) << daemon.errors();
  for (const json& location : daemon.bodies("location")) {
    EXPECT_EQ(location.at("quality").at("method"), "dscp");
    EXPECT_EQ(location.at("target").at("kind"), "TARGET_KIND_PERSON");
  }
  EXPECT_GT(located(daemon.bodies("location")), 0U) << daemon.errors();
}

}  // namespace
}  // namespace rayloc::e2e::compared_test
