#include "capture/transport/udp_address.h"

#include <arpa/inet.h>
#include <netdb.h>

#include <array>
#include <charconv>
#include <cstring>

namespace rayloc {
namespace {

tl::unexpected<Error> wrong_address(const std::string& text, const std::string& why) {
  return make_error(ErrorKind::kUsage,
                    "'" + text + "': " + why + "; write HOST:PORT, for example 127.0.0.1:5500");
}

// With or without brackets, with or without a zone.
bool is_ipv6(std::string host) {
  if (host.size() > 2 && host.front() == '[') {
    host = host.substr(1, host.find(']') - 1);
  }
  in6_addr address{};
  return inet_pton(AF_INET6, host.substr(0, host.find('%')).c_str(), &address) == 1;
}

}  // namespace

Expected<sockaddr_in> parse_udp_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) {
    return wrong_address(text, "no port");
  }
  const char* const begin = text.data() + colon + 1;
  const char* const end = text.data() + text.size();
  std::uint16_t port = 0;
  const auto parsed = std::from_chars(begin, end, port);
  if (begin == end || parsed.ec != std::errc() || parsed.ptr != end) {
    return wrong_address(text, "the port is no number from 0 to 65535");
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  const std::string host = text.substr(0, colon);
  if (host.empty() || host == "*") {
    address.sin_addr.s_addr = htonl(INADDR_ANY);
    return address;
  }
  if (is_ipv6(host) || is_ipv6(text)) {
    return wrong_address(text, "an IPv6 address, and only IPv4 is supported");
  }
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int status = getaddrinfo(host.c_str(), nullptr, &hints, &found);
  if (status != 0) {
    return wrong_address(text, std::string("the host is not known: ") + gai_strerror(status));
  }
  sockaddr_in first{};
  std::memcpy(&first, found->ai_addr, sizeof first);
  freeaddrinfo(found);
  address.sin_addr = first.sin_addr;
  return address;
}

std::string to_string(const sockaddr_in& address) {
  std::array<char, INET_ADDRSTRLEN> host{};
  inet_ntop(AF_INET, &address.sin_addr, host.data(), host.size());
  return std::string(host.data()) + ":" + std::to_string(ntohs(address.sin_port));
}

}  // namespace rayloc
