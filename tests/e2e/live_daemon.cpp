#include "tests/e2e/live_daemon.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "tests/support/test_paths.h"

namespace rayloc::e2e {
namespace {

constexpr std::chrono::seconds kPatience{120};  // of tracing a room

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

}  // namespace

bool is_free_port(int type, std::uint16_t port) {
  const int fd = socket(AF_INET, type | SOCK_CLOEXEC, 0);
  const int yes = 1;
  if (type == SOCK_STREAM) {
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  }
  sockaddr_in address = loopback(port);
  const bool bound = bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  close(fd);
  return bound;
}

// A free port. It is below the range of the kernel's own ports, so that no connection takes it
// before the daemon binds it; tests of one run differ by process.
std::uint16_t free_port(int type) {
  static int next = 15000 + static_cast<int>(getpid() % 1600) * 10;
  for (; next < 32000; ++next) {
    if (is_free_port(type, static_cast<std::uint16_t>(next))) {
      return static_cast<std::uint16_t>(next++);
    }
  }
  throw std::runtime_error("no free port");
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "rayloc-e2e.XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error("cannot make " + name);
  }
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

LiveDaemon::LiveDaemon(const std::filesystem::path& folder, const LiveDaemonOptions& options) {
  endpoint_ = "tcp://127.0.0.1:" + std::to_string(free_port(SOCK_STREAM));
  configuration_ = folder / "raylocd.toml";
  std::ofstream toml(configuration_);
  std::vector<LiveSite> sites = options.sites;
  if (sites.empty()) {
    sites.push_back({"", options.site, options.access_points});
  }
  for (const LiveSite& site : sites) {
    toml << (site.name.empty() ? "[site]\n" : "[[site]]\nname = \"" + site.name + "\"\n")
         << "directory = \"" << site.directory.string() << "\"\n"
         << site.more_configuration;
    write_sources(site, options, toml);
  }
  http_port_ = free_port(SOCK_STREAM);
  toml << "[http]\nlisten = \"127.0.0.1:" << http_port_ << "\"\n" << options.http_configuration;
  snapshot_ =
      options.snapshot.empty() ? "ipc://" + (folder / "snapshot").string() : options.snapshot;
  toml << "[publish]\nsnapshot = \"" << snapshot_ << "\"\nendpoint = \"" << endpoint_ << "\"\n"
       << options.more_configuration;
  toml.close();
  daemon_ = std::make_unique<Process>(folder,
                                      "raylocd",
                                      "raylocd",
                                      std::vector<std::string>{"--config", configuration_.string()},
                                      options.setting);
  std::vector<std::string> subscribe = {"sub", "--endpoint", endpoint_, "--json"};
  for (const auto* more : {&options.subscriber_arguments, &options.subscriptions}) {
    subscribe.insert(subscribe.end(), more->begin(), more->end());
  }
  subscriber_ = std::make_unique<Process>(folder, "sub", "rayloc", subscribe);
}

void LiveDaemon::write_sources(const LiveSite& site,
                               const LiveDaemonOptions& options,
                               std::ostream& toml) {
  for (const std::string& access_point : site.access_points) {
    udp_ports_.push_back(free_port(SOCK_DGRAM));
    const std::string port = std::to_string(udp_ports_.back());
    std::string source =
        options.source.empty() ? "kind = \"udp\"\nlisten = \"127.0.0.1:PORT\"" : options.source;
    for (const auto& [word, text] : {std::pair("PORT", port), std::pair("SITE", site.name)}) {
      if (const std::size_t at = source.find(word); at != std::string::npos) {
        source.replace(at, 4, text);
      }
    }
    toml << "[[source]]\naccess_point = \"" << access_point << "\"\n"
         << (site.name.empty() ? "" : "site = \"" + site.name + "\"\n") << source << "\n";
  }
}

bool LiveDaemon::ready() {
  return eventually(kPatience,
                    [this] {
                      if (!daemon_->running() || !subscriber_->running()) {
                        return true;  // no use waiting any longer
                      }
                      // A port is tried by taking it, which the daemon must not meet when it
                      // begins.
                      return !bodies("heartbeat").empty() &&
                             std::none_of(
                                 udp_ports_.begin(), udp_ports_.end(), [](std::uint16_t port) {
                                   return is_free_port(SOCK_DGRAM, port);
                                 });
                    }) &&
         daemon_->running() && subscriber_->running();
}

std::string LiveDaemon::address(std::size_t index) const {
  return "127.0.0.1:" + std::to_string(udp_ports_.at(index));
}

double LiveDaemon::resident_kib() const {
  constexpr std::string_view kKey = "VmRSS:";
  for (const std::string& line : read_lines("/proc/" + std::to_string(pid()) + "/status")) {
    if (line.rfind(kKey, 0) == 0) {
      return std::stod(line.substr(kKey.size()));
    }
  }
  return 0.0;  // it has ended
}

std::optional<int> LiveDaemon::stop() {
  daemon_->signal(SIGTERM);
  const std::optional<int> status = daemon_->wait(kPatience);
  // The last published messages are still on their way to the subscriber's file.
  eventually(std::chrono::seconds{10}, [this] { return !bodies("goodbye").empty(); });
  return status;
}

std::vector<nlohmann::json> LiveDaemon::bodies(const std::string& kind) const {
  std::vector<nlohmann::json> found;
  for (const std::string& line : read_lines(subscriber_->out())) {
    const nlohmann::json envelope = nlohmann::json::parse(line, nullptr, false);
    if (envelope.is_object() && envelope.contains(kind)) {  // the last line may be half written
      found.push_back(envelope.at(kind));
    }
  }
  return found;
}

std::string LiveDaemon::errors() const { return daemon_->errors() + subscriber_->errors(); }

std::optional<int> send(const std::filesystem::path& folder,
                        const std::string& name,
                        const LiveDaemon& daemon,
                        std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "send");
  for (std::size_t i = 0; i < daemon.access_points(); ++i) {
    arguments.insert(arguments.end(), {"--to", daemon.address(i)});
  }
  Process sender(folder, name, "rayloc", arguments);
  return sender.wait(std::chrono::minutes{4});
}

std::optional<int> send_for_a_second(const std::filesystem::path& folder,
                                     const LiveDaemon& daemon) {
  return send(folder,
              "send",
              daemon,
              {bundled_recording("calibration", "ap2"), "--rate", "2000", "--duration", "1"});
}

std::map<std::filesystem::path, pid_t> append_processes(pid_t daemon) {
  constexpr const char* kFile = "fd/4";  // its only file
  std::map<std::filesystem::path, pid_t> processes;
  const std::string tasks = "/proc/" + std::to_string(daemon) + "/task";
  for (const auto& task : std::filesystem::directory_iterator(tasks)) {
    std::istringstream children(read_text(task.path() / "children"));
    for (pid_t child = 0; children >> child;) {
      const std::filesystem::path process = "/proc/" + std::to_string(child);
      if (read_text(process / "comm") == "rayloc-append\n") {
        std::error_code none_yet;
        const auto file = std::filesystem::read_symlink(process / kFile, none_yet);
        if (!none_yet) {
          processes[file] = child;
        }
      }
    }
  }
  return processes;
}

std::uint64_t number(const nlohmann::json& value) {
  return value.is_string() ? std::stoull(value.get<std::string>()) : value.get<std::uint64_t>();
}

std::filesystem::path bundled(const std::string& name) {
  return std::filesystem::path(test::data_path()) / "sites/meeting_room" / name;
}

std::string bundled_recording(const std::string& name, const std::string& access_point) {
  return bundled(name + "-" + access_point + ".pcap.gz").string();
}

std::filesystem::path calibrated_site(const std::filesystem::path& folder) {
  std::filesystem::path out = folder / "calibrated";
  if (const char* const made = std::getenv("RAYLOC_CALIBRATED_SITE"); made != nullptr) {
    std::filesystem::copy(made, out, std::filesystem::copy_options::recursive);
    return out;
  }
  std::vector<std::string> arguments = {"calibrate", bundled("").string(), "--gains-only"};
  arguments.emplace_back("--capture");
  for (const std::string access_point : {"ap1", "ap2", "ap3"}) {
    arguments.push_back(access_point + "=" + bundled_recording("calibration", access_point));
  }
  for (const std::string& word : {std::string("--points"),
                                  bundled("calibration.csv").string(),
                                  std::string("--out"),
                                  out.string()}) {
    arguments.push_back(word);
  }
  Process calibrate(folder, "calibrate", "rayloc", arguments);
  if (calibrate.wait(std::chrono::minutes{4}) != 0) {
    throw std::runtime_error("rayloc calibrate failed\n" + calibrate.errors());
  }
  return out;
}

}  // namespace rayloc::e2e
