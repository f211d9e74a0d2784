// A power cycle of an access point as the operator and the subscribers of a running raylocd see it:
// the warning is in the journal, the heartbeat and the locations, and no warning precedes it.
#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/e2e/live_daemon.h"

namespace rayloc::e2e::calibration_warnings_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::array kAccessPoints = {"ap1", "ap2", "ap3"};
constexpr std::chrono::seconds kPatience{120};
constexpr const char* kPlug = "02:52:4c:00:00:02";  // fixed, as the bundled site states
constexpr const char* kJump = "chain_phase_jump: access point ap1, core ";

class CalibrationWarnings : public ::testing::Test {
 protected:
  CalibrationWarnings() : site_(calibrated_site(folder_.path())) {
    std::ofstream(path("other.toml")) << "calibrated_chains = false\n";
    // Bursts of the fixed transmitter at its place, farther apart than what ends a burst at the
    // speed they are sent with; the same of a device that a location is asked of.
    std::ofstream plug(path("plug.csv"));
    std::ofstream device(path("device.csv"));
    plug << "t_start,t_end,x,y,z\n";
    device << "t_start,t_end,x,y,z\n";
    for (int i = 0; i < 24; ++i) {
      const std::string times =
          std::to_string(5000 + 2 * i) + "," + std::to_string(5000.2 + 2 * i) + ",";
      plug << times << "1.25,-0.45,1.2\n";
      if (i < 2) {
        device << times << "0.4,-0.2,1.2\n";
      }
    }
  }

  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string recording(const std::string& name, const std::string& access_point) const {
    return path(name).append("-").append(access_point).append(".pcap");
  }

  // Makes the recordings NAME-apN.pcap; with new phases of the chains unless `calibrated`.
  void simulate(const std::string& name, const std::string& transmitter, bool calibrated) const {
    std::vector<std::string> arguments = {"simulate", site_.string(), "--quiet", "--seed", "7"};
    arguments.insert(arguments.end(),
                     {"--impairments", calibrated ? "default" : path("other.toml")});
    if (!transmitter.empty()) {
      arguments.insert(arguments.end(), {"--transmitter", transmitter});
    }
    arguments.insert(arguments.end(),
                     {"--points", path(transmitter.empty() ? "device.csv" : "plug.csv"), "--out"});
    for (const std::string access_point : kAccessPoints) {
      arguments.push_back(
          std::string(access_point).append("=").append(recording(name, access_point)));
    }
    Process simulation(folder_.path(), "simulate-" + name, "rayloc", arguments);
    ASSERT_EQ(simulation.wait(kPatience), 0) << simulation.errors();
  }

  void replay(const std::string& name, const LiveDaemon& daemon) const {
    std::vector<std::string> arguments = {"--speed", "4"};
    for (const std::string access_point : kAccessPoints) {
      arguments.push_back(recording(name, access_point));
    }
    ASSERT_EQ(send(folder_.path(), "send-" + name, daemon, arguments), 0);
  }

  TemporaryFolder folder_;
  std::filesystem::path site_;
};

std::string warnings_of(const nlohmann::json& heartbeat) {
  return heartbeat.value("calibration_warnings", nlohmann::json::array()).dump();
}

TEST_F(CalibrationWarnings, ReachJournalHeartbeatAndLocationsAfterAPowerCycle) {
  simulate("same", kPlug, true);
  simulate("other", kPlug, false);
  simulate("device", "", false);
  LiveDaemon daemon(folder_.path(), {.site = site_});
  ASSERT_TRUE(daemon.ready()) << daemon.errors();

  replay("same", daemon);
  const std::size_t received = daemon.bodies("heartbeat").size();
  ASSERT_TRUE(
      eventually(kPatience, [&] { return daemon.bodies("heartbeat").size() > received + 1; }));
  EXPECT_EQ(warnings_of(daemon.bodies("heartbeat").back()), "[]");
  EXPECT_THAT(daemon.errors(), Not(HasSubstr("chain_phase_jump")));

  replay("other", daemon);
  EXPECT_TRUE(eventually(kPatience, [&] {
    return warnings_of(daemon.bodies("heartbeat").back()).find(kJump) != std::string::npos;
  })) << daemon.bodies("heartbeat").back().dump();
  EXPECT_THAT(daemon.errors(), HasSubstr(kJump));

  replay("device", daemon);
  const auto warned = [](const nlohmann::json& location) {
    return location.at("quality").value("warnings", nlohmann::json::array()).dump().find(kJump) !=
           std::string::npos;
  };
  EXPECT_TRUE(eventually(kPatience, [&] { return !daemon.bodies("location").empty(); }));
  EXPECT_EQ(daemon.stop(), 0) << daemon.errors();
  const std::vector<nlohmann::json> locations = daemon.bodies("location");
  ASSERT_FALSE(locations.empty());
  EXPECT_TRUE(std::all_of(locations.begin(), locations.end(), warned)) << locations[0].dump();
}

}  // namespace
}  // namespace rayloc::e2e::calibration_warnings_test
