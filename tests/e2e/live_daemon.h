// LiveDaemon: raylocd as a real process on free ports, with a subscriber that writes everything it
// publishes to a file.
//
//   LiveDaemon daemon(folder, {.site = calibrated});
//   ASSERT_TRUE(daemon.ready()) << daemon.errors();
//   Process sender(folder, "send", "rayloc", {"send", file, "--to", daemon.address(0)});
//   ...
//   EXPECT_EQ(daemon.stop(), 0);
//   for (const nlohmann::json& location : daemon.bodies("location")) ...
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/e2e/process.h"

namespace rayloc::e2e {

// A folder under the system's temporary one, removed with what it holds.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct LiveDaemonOptions {
  std::filesystem::path site;
  std::vector<std::string> access_points = {"ap1", "ap2", "ap3"};
  std::string more_configuration = {};  // TOML behind what the fixture writes
};

class LiveDaemon {
 public:
  LiveDaemon(const std::filesystem::path& folder, const LiveDaemonOptions& options);

  // Waits until every port is bound and a heartbeat has reached the subscriber: from then on it
  // misses nothing. False when that does not happen.
  bool ready();
  // Where access point `index` sends to, as HOST:PORT.
  std::string address(std::size_t index) const;
  void signal(int number) { daemon_->signal(number); }
  // Ends the daemon as a service manager would; its exit status, nothing when it hangs.
  std::optional<int> stop();

  // The bodies of that kind ("location", "heartbeat", "goodbye") received so far, in order.
  std::vector<nlohmann::json> bodies(const std::string& kind) const;
  std::string errors() const;

 private:
  std::vector<std::uint16_t> udp_ports_;
  std::uint16_t publish_port_ = 0;
  std::unique_ptr<Process> daemon_;
  std::unique_ptr<Process> subscriber_;
};

// 64-bit numbers are strings in protobuf's JSON.
std::uint64_t number(const nlohmann::json& value);

// Calibrates the gains of the bundled site into `folder`/calibrated, and returns that. Throws when
// `rayloc calibrate` fails.
std::filesystem::path calibrated_site(const std::filesystem::path& folder);

// A recording of the bundled site: "device_los", "calibration".
std::filesystem::path bundled(const std::string& name);
std::string bundled_recording(const std::string& name, const std::string& access_point);

}  // namespace rayloc::e2e
