#include "daemon/live/cluster/operate/server_greeting.h"

#include <netdb.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string_view>

#include <nlohmann/json.hpp>

#include "capture/transport/file_descriptor.h"

namespace rayloc {
namespace {

constexpr std::string_view kBegin = "INFO ";
constexpr std::size_t kLongest = std::size_t{64} << 10U;  // bytes of a greeting

tl::unexpected<Error> silent(const std::string& server, const std::string& why) {
  return make_error(ErrorKind::kUnavailable, server + ": " + why);
}

// Reads its first line.
Expected<std::string> line_of(const std::string& server, std::chrono::milliseconds patience) {
  const std::size_t scheme = server.find("://");
  const std::size_t begin = scheme == std::string::npos ? 0 : scheme + 3;
  const std::size_t colon = server.rfind(':');
  const bool has_port =
      colon != std::string::npos && colon > begin && server.find(']', colon) == std::string::npos;
  const std::string port = has_port ? server.substr(colon + 1) : "4222";
  std::string host = server.substr(begin, has_port ? colon - begin : std::string::npos);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int failed = getaddrinfo(host.c_str(), port.c_str(), &hints, &found); failed != 0) {
    return silent(server, gai_strerror(failed));
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> address(found, freeaddrinfo);
  const FileDescriptor peer(::socket(address->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0));
  timeval limit{};
  limit.tv_sec = patience.count() / 1000;
  limit.tv_usec = 1000 * (patience.count() % 1000);
  setsockopt(peer.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  setsockopt(peer.get(), SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
  if (::connect(peer.get(), address->ai_addr, address->ai_addrlen) != 0) {
    return silent(server, std::strerror(errno));
  }
  std::string line;
  std::array<char, 4096> some{};
  while (line.find('\n') == std::string::npos && line.size() < kLongest) {
    const ssize_t read = ::recv(peer.get(), some.data(), some.size(), 0);
    if (read <= 0) {
      return silent(server, read == 0 ? "hangs up" : "sends nothing");
    }
    line.append(some.data(), static_cast<std::size_t>(read));
  }
  return line;
}

}  // namespace

Expected<ServerGreeting> greeting_of(const std::string& server,
                                     std::chrono::milliseconds patience) {
  const Expected<std::string> line = line_of(server, patience);
  RAYLOC_TRY(line);
  const auto json = line->rfind(kBegin, 0) == 0
                        ? nlohmann::json::parse(line->substr(kBegin.size()), nullptr, false)
                        : nlohmann::json();
  if (!json.is_object()) {
    return silent(server, "the peer is no NATS server");
  }
  const auto text = [&](const char* key) {
    return json.contains(key) && json.at(key).is_string() ? json.at(key).get<std::string>() : "";
  };
  const auto flag = [&](const char* key) {
    return json.contains(key) && json.at(key).is_boolean() && json.at(key).get<bool>();
  };
  ServerGreeting greeting;
  greeting.version = text("version");
  greeting.cluster = text("cluster");
  greeting.jetstream = flag("jetstream");
  greeting.asks_for_tls = flag("tls_required");
  greeting.asks_who = flag("auth_required");
  return greeting;
}

}  // namespace rayloc
