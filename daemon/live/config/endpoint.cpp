#include "daemon/live/config/endpoint.h"

#include <arpa/inet.h>
#include <sys/un.h>

#include <charconv>

namespace rayloc {
namespace {

constexpr std::string_view kEveryAddress = "0.0.0.0";
constexpr std::string_view kLoopbackAddress = "127.0.0.1";

std::optional<std::uint16_t> parse_port(std::string_view text) {
  std::uint16_t port = 0;
  const char* end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, port);
  return status == std::errc() && stop == end ? std::optional(port) : std::nullopt;
}

// The address in host order.
std::optional<std::uint32_t> parse_ipv4(const std::string& host) {
  in_addr address{};
  return inet_pton(AF_INET, host.c_str(), &address) == 1 ? std::optional(ntohl(address.s_addr))
                                                         : std::nullopt;
}

// In brackets, as in URLs, or without.
bool is_ipv6(std::string_view host) {
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  in6_addr address{};
  return inet_pton(AF_INET6, std::string(host).c_str(), &address) == 1;
}

}  // namespace

bool is_loopback(const std::string& host) {
  constexpr std::uint32_t kLoopbackNetwork = 127;
  const std::optional<std::uint32_t> address = parse_ipv4(host);
  return host == "[::1]" || host == "localhost" || (address && *address >> 24U == kLoopbackNetwork);
}

std::optional<ListenAddress> parse_listen(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) {
    return std::nullopt;
  }
  std::string host(text.substr(0, colon));
  if (host.empty() || host == "*") {
    host = kEveryAddress;
  } else if (host == "localhost") {
    host = kLoopbackAddress;
  }
  const std::optional<std::uint16_t> port = parse_port(text.substr(colon + 1));
  if (!port || !parse_ipv4(host)) {
    return std::nullopt;
  }
  return ListenAddress{std::move(host), *port};
}

std::string listen_fault(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  const bool bracketed = text.substr(0, 1) == "[" && text.find(']') != std::string_view::npos;
  if (bracketed || is_ipv6(text) ||
      (colon != std::string_view::npos && is_ipv6(text.substr(0, colon)))) {
    return "is an IPv6 address, and only IPv4 is supported";
  }
  return "is no ADDRESS:PORT";
}

bool same_port(const ListenAddress& a, const ListenAddress& b) {
  return a.port == b.port && a.port != 0 &&
         (parse_ipv4(a.host) == parse_ipv4(b.host) || a.host == kEveryAddress ||
          b.host == kEveryAddress);
}

EndpointReach endpoint_reach(std::string_view endpoint) {
  constexpr std::string_view kTcp = "tcp://";
  constexpr std::string_view kIpc = "ipc://";
  if (endpoint.substr(0, kIpc.size()) == kIpc) {
    // The kernel's limit of the path, including its terminating zero.
    const std::size_t length = endpoint.size() - kIpc.size();
    return length > 0 && length < sizeof(sockaddr_un::sun_path) ? EndpointReach::kLoopback
                                                                : EndpointReach::kInvalid;
  }
  if (endpoint.substr(0, kTcp.size()) != kTcp) {
    return EndpointReach::kInvalid;
  }
  const std::string_view address = endpoint.substr(kTcp.size());
  const std::size_t colon = address.rfind(':');
  if (colon == std::string_view::npos || colon == 0) {
    return EndpointReach::kInvalid;
  }
  const std::string_view port = address.substr(colon + 1);
  if (port != "*" && parse_port(port).value_or(0) == 0) {  // "*": any free one
    return EndpointReach::kInvalid;
  }
  const std::string host(address.substr(0, colon));
  if (is_loopback(host)) {
    return EndpointReach::kLoopback;
  }
  return host == "*" || parse_ipv4(host) || is_ipv6(host) ? EndpointReach::kNetwork
                                                          : EndpointReach::kNamed;
}

}  // namespace rayloc
