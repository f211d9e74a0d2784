#include "daemon/live/service/passed_socket_check.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string_view>

#include "daemon/live/config/endpoint.h"

namespace rayloc {
namespace {

using Family = SocketDemand::Family;

// Empty if `fd` is no socket.
std::optional<int> socket_option(int fd, int option) {
  int value = 0;
  socklen_t size = sizeof value;
  return getsockopt(fd, SOL_SOCKET, option, &value, &size) == 0 ? std::optional(value)
                                                                : std::nullopt;
}

// "an AF_UNIX datagram socket", for messages.
std::string description(int fd) {
  const std::optional<int> type = socket_option(fd, SO_TYPE);
  if (!type) {
    return "no socket";
  }
  const int domain = socket_option(fd, SO_DOMAIN).value_or(AF_UNSPEC);
  const std::string family = domain == AF_UNIX                         ? "an AF_UNIX "
                             : domain == AF_INET || domain == AF_INET6 ? "an Internet "
                                                                       : "another ";
  if (*type == SOCK_DGRAM) {
    return family + "datagram socket";
  }
  if (*type != SOCK_STREAM) {
    return family + "socket that is neither of streams nor of datagrams";
  }
  return family + (socket_option(fd, SO_ACCEPTCONN).value_or(0) != 0
                       ? "stream socket"
                       : "stream socket that does not listen");
}

bool is_of(Family family, int fd) {
  const int domain = socket_option(fd, SO_DOMAIN).value_or(AF_UNSPEC);
  const bool internet = domain == AF_INET || domain == AF_INET6;
  switch (family) {
    case Family::kAny:
      return internet || domain == AF_UNIX;
    case Family::kInternet:
      return internet;
    case Family::kUnix:
      return domain == AF_UNIX;
  }
  return false;
}

bool is_as_demanded(int fd, const SocketDemand& demand) {
  const int type = demand.listening ? SOCK_STREAM : SOCK_DGRAM;
  return socket_option(fd, SO_TYPE) == type && is_of(demand.family, fd) &&
         (!demand.listening || socket_option(fd, SO_ACCEPTCONN).value_or(0) != 0);
}

// Address reachable from other machines: "0.0.0.0:8480"; empty if only this machine reaches it.
std::optional<std::string> reachable_address(int fd) {
  sockaddr_storage bound{};
  socklen_t size = sizeof bound;
  if (getsockname(fd, reinterpret_cast<sockaddr*>(&bound), &size) != 0) {
    return "an unknown address";
  }
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (bound.ss_family == AF_INET) {
    sockaddr_in v4{};
    std::memcpy(&v4, &bound, sizeof v4);
    inet_ntop(AF_INET, &v4.sin_addr, text.data(), text.size());
    return is_loopback(text.data())
               ? std::nullopt
               : std::optional(std::string(text.data()) + ":" + std::to_string(ntohs(v4.sin_port)));
  }
  if (bound.ss_family == AF_INET6) {
    constexpr std::uint8_t kLoopbackNetwork = 127;
    sockaddr_in6 v6{};
    std::memcpy(&v6, &bound, sizeof v6);
    inet_ntop(AF_INET6, &v6.sin6_addr, text.data(), text.size());
    const bool mapped_loopback =
        IN6_IS_ADDR_V4MAPPED(&v6.sin6_addr) && v6.sin6_addr.s6_addr[12] == kLoopbackNetwork;
    return IN6_IS_ADDR_LOOPBACK(&v6.sin6_addr) || mapped_loopback
               ? std::nullopt
               : std::optional("[" + std::string(text.data()) +
                               "]:" + std::to_string(ntohs(v6.sin6_port)));
  }
  return std::nullopt;  // a path
}

// "tcp://127.0.0.1:5560" -> "ListenStream=127.0.0.1:5560"
std::string listen_line(const std::string& endpoint) {
  constexpr std::string_view kScheme = "tcp://";  // as long as ipc://
  return "ListenStream=" + endpoint.substr(kScheme.size());
}

SocketDemand publishing_demand(const std::string& name,
                               const std::string& endpoint,
                               const DaemonConfig& config) {
  SocketDemand demand;
  demand.unit = "raylocd-" + name + ".socket";
  demand.line = listen_line(endpoint);
  demand.family = endpoint.rfind("ipc://", 0) == 0 ? Family::kUnix : Family::kInternet;
  if (!config.publish.insecure && !config.curve.enabled) {
    demand.precaution = "set up [curve], or insecure = true in [publish]";
  }
  return demand;
}

SocketDemand http_demand(const HttpConfig& http) {
  SocketDemand demand;
  demand.unit = "raylocd-http.socket";
  demand.line = "ListenStream=" + http.host + ":" + std::to_string(http.port);
  if (http.edit && http.token_file.empty()) {
    demand.precaution = "set token_file in [http], which edit needs";
  } else if (!http.insecure && http.token_file.empty()) {
    demand.precaution = "set token_file, or insecure = true, in [http]";
  }
  return demand;
}

SocketDemand source_demand(const SourceConfig& source) {
  const bool udp = source.kind == SourceKind::kUdp;
  SocketDemand demand;
  demand.unit = "raylocd-source@" + source.instance + ".socket";
  demand.line = "ListenDatagram=" +
                (udp ? "0.0.0.0:" + std::to_string(source.listen_port) : source.path.string());
  demand.listening = false;
  demand.family = udp ? Family::kInternet : Family::kUnix;
  return demand;
}

// The daemon then has no interfaces of its own (PrivateNetwork=) among which to find the name.
tl::unexpected<Error> only_interface_error(const SourceConfig& source, const std::string& unit) {
  return make_error(ErrorKind::kConfiguration,
                    source.place +
                        "'only_interface' does not go with a socket that systemd passes (" + unit +
                        "); leave it out, and write BindToDevice=" + source.only_interface +
                        " in [Socket] of that unit");
}

}  // namespace

bool takes_socket(const SourceConfig& source) {
  return source.kind == SourceKind::kUdp || source.kind == SourceKind::kUnix;
}

Expected<void> check_passed_socket(int fd, const SocketDemand& demand) {
  if (!is_as_demanded(fd, demand)) {
    return make_error(ErrorKind::kConfiguration,
                      demand.unit + " passes " + description(fd) + "; it must have " + demand.line);
  }
  const std::optional<std::string> address = reachable_address(fd);
  if (!address || demand.precaution.empty()) {
    return {};
  }
  return make_error(ErrorKind::kConfiguration,
                    demand.unit + " listens at " + *address +
                        ", which can be reached from the network, where everyone could read who is "
                        "where; write " +
                        demand.line + " there, or " + demand.precaution + ", if that is meant");
}

Expected<void> check_passed_sockets(const PassedSockets& sockets, const DaemonConfig& config) {
  std::map<std::string, SocketDemand> demands = {
      {"publish", publishing_demand("publish", config.publish.endpoint, config)},
      {"snapshot", publishing_demand("snapshot", config.publish.snapshot, config)}};
  if (config.http.enabled) {
    demands["http"] = http_demand(config.http);
  }
  for (const SourceConfig& source : config.sources) {
    if (!takes_socket(source)) {
      continue;
    }
    const SocketDemand demand = source_demand(source);
    const std::string name = "source-" + source.instance;
    if (sockets.find(name) && !source.only_interface.empty()) {
      return only_interface_error(source, demand.unit);
    }
    demands[name] = demand;
  }
  for (const auto& [name, demand] : demands) {
    const std::optional<int> fd = sockets.find(name);
    if (!fd) {
      continue;
    }
    RAYLOC_TRY(check_passed_socket(*fd, demand));
  }
  return {};
}

}  // namespace rayloc
