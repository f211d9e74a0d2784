#include "daemon/live/machine/machine_check.h"

#include <net/if.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>

#include "daemon/base/secret_file.h"
#include "daemon/live/config/recording_files.h"
#include "daemon/live/health/readiness.h"
#include "daemon/live/publish/socket/curve_keys.h"

namespace rayloc {
namespace {

namespace fs = std::filesystem;
using Kind = Finding::Kind;

// Size that UdpSource requests; below it datagrams are lost in bursts.
constexpr std::int64_t kReceiveBuffer = std::int64_t{8} << 20U;
constexpr std::uintmax_t kFewBytes = std::uintmax_t{1} << 30U;

Finding check_receive_buffer() {
  std::int64_t granted = 0;
  std::ifstream("/proc/sys/net/core/rmem_max") >> granted;
  const std::string what = "net.core.rmem_max is " + std::to_string(granted);
  if (granted >= kReceiveBuffer) {
    return {Kind::kOk, what, ""};
  }
  return {Kind::kWarning,
          what + ": bursts of datagrams may be lost",
          "sysctl -w net.core.rmem_max=" + std::to_string(kReceiveBuffer) +
              ", and the same line in /etc/sysctl.d"};
}

Finding check_clock() {
  switch (clock_state()) {
    case ClockState::kSynchronized:
      return {Kind::kOk, "the clock is synchronised", ""};
    case ClockState::kNotSynchronized:
      return {Kind::kWarning,
              "the clock is not synchronised: times of locations are off",
              "run chrony or systemd-timesyncd"};
    case ClockState::kUnknown:
      break;
  }
  return {Kind::kWarning, "the synchronisation of the clock is unknown", "run timedatectl"};
}

// The folder, or the nearest one above it that exists.
fs::path existing(fs::path folder) {
  std::error_code failed;
  while (!folder.empty() && folder != folder.root_path() && !fs::exists(folder, failed)) {
    folder = folder.parent_path();
  }
  return folder.empty() ? fs::path(".") : folder;
}

Finding check_disk(const std::string& what_for, const fs::path& directory, std::uint64_t min_free) {
  const fs::path folder = existing(directory);
  std::error_code failed;
  const fs::space_info space = fs::space(folder, failed);
  const std::string name = what_for + " in " + directory.string();
  if (failed) {
    return {Kind::kProblem, name + ": " + failed.message(), "name another folder in [record]"};
  }
  const std::string what = name + ": " + std::to_string(space.available >> 20U) + " MiB free";
  if (access(folder.c_str(), W_OK) != 0) {
    return {Kind::kWarning, name + ": " + std::strerror(errno), "raylocd's user must write there"};
  }
  if (space.available < min_free) {
    return {Kind::kProblem,
            what + ", less than min_free_mb: nothing is written",
            "make room, or lower min_free_mb in [record]"};
  }
  return space.available < kFewBytes ? Finding{Kind::kWarning, what, "make room"}
                                     : Finding{Kind::kOk, what, ""};
}

// Null when the port is available, otherwise the reason. `host`: address or name of this machine.
std::optional<std::string> refusal(int type, const std::string& host, const std::string& port) {
  addrinfo hints{};
  hints.ai_socktype = type;
  addrinfo* found = nullptr;
  const bool bracketed = !host.empty() && host.front() == '[';
  const std::string bare = bracketed ? host.substr(1, host.size() - 2) : host;
  if (const int failed = getaddrinfo(bare.c_str(), port.c_str(), &hints, &found); failed != 0) {
    return gai_strerror(failed);
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> address(found, freeaddrinfo);
  const int fd = socket(address->ai_family, type | SOCK_CLOEXEC, 0);
  if (fd < 0) {
    return std::strerror(errno);
  }
  if (type == SOCK_STREAM) {
    const int yes = 1;
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  }
  const bool bound = bind(fd, address->ai_addr, address->ai_addrlen) == 0;
  const int error = errno;
  close(fd);
  return bound ? std::nullopt : std::optional<std::string>(std::strerror(error));
}

// `address`: HOST:PORT.
Finding check_port(const std::string& name, const std::string& address, int type, bool running) {
  const std::string what = name + " " + address;
  const std::size_t colon = address.rfind(':');
  const std::optional<std::string> why =
      refusal(type, address.substr(0, colon), address.substr(colon + 1));
  if (!why || running) {
    return {Kind::kOk, what + (why ? " is in use, raylocd runs" : " is free"), ""};
  }
  return {Kind::kProblem, what + ": " + *why, "see who has it: ss -lnup, ss -lntp"};
}

std::string address_text(const std::string& host, std::uint16_t port) {
  return host + ":" + std::to_string(port);
}

// Secrets belong to the user that raylocd runs as; the caller may be another user.
Finding check_secret(const std::string& key, const fs::path& file) {
  const std::string what = key + " " + file.string();
  if (const auto checked = check_private(file, {"secret", ""}); !checked) {
    return {Kind::kProblem, key + " " + checked.error().message, ""};
  }
  if (access(file.c_str(), R_OK) == 0) {
    return {Kind::kOk, what + " can be read", ""};
  }
  const int error = errno;
  return {error == EACCES ? Kind::kWarning : Kind::kProblem,
          what + ": " + std::strerror(error),
          error == EACCES ? "raylocd's user must read it" : "write it, or name another file"};
}

Finding check_interface(const SourceConfig& source) {
  const std::string what = "source " + source.access_point + ": interface " + source.interface;
  if (source.interface != "any" && if_nametoindex(source.interface.c_str()) == 0) {
    return {Kind::kProblem, what + " does not exist", "ip link lists what there is"};
  }
  const int fd = socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, 0);
  if (fd < 0) {
    return {Kind::kWarning,
            what + ": this user may not capture",
            "the unit needs the drop-in live-capture.conf (CAP_NET_RAW)"};
  }
  close(fd);
  return {Kind::kOk, what + " can be captured", ""};
}

Finding check_folder_of(const SourceConfig& source) {
  const std::filesystem::path folder = source.path.parent_path();
  const std::string what = "source " + source.access_point + ": socket " + source.path.string();
  if (access(folder.c_str(), F_OK) != 0) {
    return {Kind::kWarning,
            what + ": " + folder.string() + ": " + std::strerror(errno),
            "raylocd.service makes /run/raylocd; make other folders yourself"};
  }
  return {Kind::kOk, what + " has a folder", ""};
}

Finding check_source(const SourceConfig& source, bool running) {
  switch (source.kind) {
    case SourceKind::kUdp:
      return check_port("source " + source.access_point + ": UDP",
                        address_text(source.listen_host, source.listen_port),
                        SOCK_DGRAM,
                        running);
    case SourceKind::kInterface:
      return check_interface(source);
    case SourceKind::kUnix:
      return check_folder_of(source);
    case SourceKind::kOther:
      return {Kind::kOk, "source " + source.access_point + ": " + source.url, ""};
    case SourceKind::kCluster:
      return {Kind::kOk, "source " + source.access_point + ": the stream of its site", ""};
    case SourceKind::kPcap:
      break;
  }
  std::string names;
  for (const std::string& file : recording_files(source)) {
    names += (names.empty() ? "" : ", ") + file;
    if (file != "-" && access(file.c_str(), R_OK) != 0) {
      return {Kind::kProblem,
              "source " + source.access_point + ": " + file + ": " + std::strerror(errno),
              "name a recording that can be read"};
    }
  }
  return {Kind::kOk, "source " + source.access_point + ": " + names, ""};
}

// Checks the TCP port of a ZeroMQ endpoint.
void check_endpoint(const std::string& name,
                    const std::string& endpoint,
                    bool running,
                    std::vector<Finding>& findings) {
  constexpr std::string_view kTcp = "tcp://";
  constexpr std::string_view kAnyPort = ":*";
  std::string address = endpoint;
  if (endpoint.rfind(kTcp, 0) != 0 || endpoint.size() <= kTcp.size() + kAnyPort.size() ||
      endpoint.compare(endpoint.size() - kAnyPort.size(), kAnyPort.size(), kAnyPort) == 0) {
    return;  // a path, or any free port
  }
  address.erase(0, kTcp.size());
  if (address.front() == '*') {
    address.replace(0, 1, "0.0.0.0");
  }
  constexpr std::string_view kLocalhost = "localhost:";
  if (address.rfind(kLocalhost, 0) == 0) {  // as listen_on_tcp() reads it
    address.replace(0, kLocalhost.size(), "127.0.0.1:");
  }
  findings.push_back(check_port(name, address, SOCK_STREAM, running));
}

// systemd passes the credential to its unit only; here it would already be in `secret_file`.
Finding check_curve(const CurveConfig& curve, bool running) {
  if (curve.secret_file.empty()) {
    return running
               ? Finding{Kind::kOk, "[curve]: raylocd runs, so it has its secret key", ""}
               : Finding{Kind::kWarning,
                         "[curve]: no secret_file, and no credential curve.secret is seen here: "
                         "raylocd does not start without",
                         "set secret_file, or see that the unit has the drop-in curve.conf; to "
                         "look as the daemon will: CREDENTIALS_DIRECTORY=/etc/raylocd"};
  }
  const Expected<CurveKeyPair> keys = read_curve_secret(curve.secret_file);
  return keys ? Finding{Kind::kOk, "[curve]: our public key is " + keys->public_key, ""}
              : Finding{Kind::kProblem, "[curve]: " + keys.error().message, ""};
}

}  // namespace

std::vector<Finding> check_machine(const DaemonConfig& config, bool running) {
  std::vector<Finding> findings = {check_receive_buffer(), check_clock()};
  const RecordConfig& record = config.record;
  if (!record.directory.empty()) {
    findings.push_back(check_disk("recordings", record.directory, record.min_free_bytes));
  }
  if (!record.snapshot_directory.empty() && record.snapshot_directory != record.directory) {
    findings.push_back(check_disk("snapshots", record.snapshot_directory, record.min_free_bytes));
  }
  for (const SourceConfig& source : config.sources) {
    findings.push_back(check_source(source, running));
  }
  check_endpoint("publishing", config.publish.endpoint, running, findings);
  check_endpoint("snapshots", config.publish.snapshot, running, findings);
  if (config.curve.enabled) {
    findings.push_back(check_curve(config.curve, running));
  }
  if (config.privacy.target_id == TargetId::kHmac && !config.privacy.key_file.empty()) {
    findings.push_back(check_secret("[privacy] key_file", config.privacy.key_file));
  }
  if (!config.cluster.nkey_seed_file.empty()) {
    findings.push_back(check_secret("[cluster] nkey_seed_file", config.cluster.nkey_seed_file));
  }
  if (config.http.enabled) {
    findings.push_back(
        check_port("HTTP", address_text(config.http.host, config.http.port), SOCK_STREAM, running));
    if (!config.http.token_file.empty()) {
      findings.push_back(check_secret("[http] token_file", config.http.token_file));
    }
  }
  return findings;
}

}  // namespace rayloc
