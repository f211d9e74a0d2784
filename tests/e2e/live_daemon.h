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
#include <map>
#include <memory>
#include <optional>
#include <ostream>
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

// One of several sites.
struct LiveSite {
  std::string name;
  std::filesystem::path directory;
  std::vector<std::string> access_points = {"ap2"};
  std::string more_configuration = {};  // further keys of its [[site]]
};

struct LiveDaemonOptions {
  std::filesystem::path site = {};
  std::vector<std::string> access_points = {"ap1", "ap2", "ap3"};
  std::string more_configuration = {};  // TOML after the fixture's own
  std::string http_configuration = {};  // further keys of [http]
  // TOML of each [[source]] instead of a UDP port; SITE in it is replaced by the site's name, and
  // PORT by the port that the access point sends to, which the test then binds: ready() waits for
  // that.
  std::string source = {};
  // [[site]] instead of `site` and `access_points`; addresses are in their order.
  std::vector<LiveSite> sites = {};
  std::string snapshot = {};  // endpoint; empty: a socket in the folder
  ProcessSetting setting = {};
  std::vector<std::string> subscriptions = {"v1/"};    // of the subscriber
  std::vector<std::string> subscriber_arguments = {};  // further ones of `rayloc sub`
};

// A free port, of SOCK_DGRAM or SOCK_STREAM.
std::uint16_t free_port(int type);
// True if no process has that port.
bool is_free_port(int type, std::uint16_t port);

// The processes that append to the recordings of a raylocd (capture/record/append_process.h), by
// the file.
std::map<std::filesystem::path, pid_t> append_processes(pid_t daemon);

class LiveDaemon {
 public:
  LiveDaemon(const std::filesystem::path& folder, const LiveDaemonOptions& options);

  // Waits until every port is bound and a heartbeat has reached the subscriber: from then on it
  // misses nothing. False if that does not happen.
  bool ready();
  // The address that access point `index` sends to, as HOST:PORT.
  std::string address(std::size_t index) const;
  std::uint16_t port(std::size_t index) const { return udp_ports_.at(index); }
  std::size_t access_points() const { return udp_ports_.size(); }
  void signal(int number) { daemon_->signal(number); }
  bool running() { return daemon_->running(); }
  pid_t pid() const { return daemon_->pid(); }
  double resident_kib() const;  // of the daemon's memory
  std::optional<int> wait(std::chrono::seconds patience) { return daemon_->wait(patience); }
  // The log of the daemon so far.
  std::string log() const { return daemon_->errors(); }
  const std::filesystem::path& configuration() const { return configuration_; }
  const std::string& snapshot() const { return snapshot_; }
  std::uint16_t http_port() const { return http_port_; }
  const std::string& endpoint() const { return endpoint_; }
  // Ends the daemon as a service manager would; its exit status, nothing if it hangs.
  std::optional<int> stop();

  // The bodies of that kind ("location", "heartbeat", "goodbye") received so far, in order.
  std::vector<nlohmann::json> bodies(const std::string& kind) const;
  std::string errors() const;

 private:
  void write_sources(const LiveSite& site, const LiveDaemonOptions& options, std::ostream& toml);

  std::vector<std::uint16_t> udp_ports_;
  std::uint16_t http_port_ = 0;
  std::string endpoint_;
  std::string snapshot_;
  std::filesystem::path configuration_;
  std::unique_ptr<Process> daemon_;
  std::unique_ptr<Process> subscriber_;
};

// Runs `rayloc send` with these arguments and every access point of the daemon, in order, as --to;
// its messages go to NAME.err in `folder`. Its exit status, nothing if it hangs.
std::optional<int> send(const std::filesystem::path& folder,
                        const std::string& name,
                        const LiveDaemon& daemon,
                        std::vector<std::string> arguments);
// 2,000 datagrams of one access point, within a second.
std::optional<int> send_for_a_second(const std::filesystem::path& folder, const LiveDaemon& daemon);

// 64-bit numbers are strings in protobuf's JSON.
std::uint64_t number(const nlohmann::json& value);

// Calibrates the gains of the bundled site into `folder`/calibrated, and returns that. Throws when
// `rayloc calibrate` fails. RAYLOC_CALIBRATED_SITE: where that has been done before, for programs
// that take minutes for it.
std::filesystem::path calibrated_site(const std::filesystem::path& folder);

// A recording of the bundled site: "device_los", "calibration".
std::filesystem::path bundled(const std::string& name);
std::string bundled_recording(const std::string& name, const std::string& access_point);

}  // namespace rayloc::e2e
