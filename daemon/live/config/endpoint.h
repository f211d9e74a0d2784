// Addresses in the notation of the configuration.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace rayloc {

struct ListenAddress {
  std::string host;  // numeric IPv4
  std::uint16_t port = 0;
};

// "0.0.0.0:5500"; "*" and an empty host denote every address, "localhost" 127.0.0.1. Otherwise
// numeric, so that a start does not depend on a name server.
std::optional<ListenAddress> parse_listen(std::string_view text);

// The reason why it cannot be parsed, to follow the name of a key: "is no ADDRESS:PORT".
std::string listen_fault(std::string_view text);

// True if an address of this machine, or "localhost", reaches this machine only.
bool is_loopback(const std::string& host);

// True if two UDP sockets could not both be bound.
bool same_port(const ListenAddress& a, const ListenAddress& b);

// The machines from which a ZeroMQ endpoint that we bind is reachable.
enum class EndpointReach {
  kInvalid,   // neither tcp://HOST:PORT nor ipc://PATH
  kNamed,     // name of a host or an interface, which is not resolved
  kLoopback,  // this machine only
  kNetwork,   // other machines as well
};
EndpointReach endpoint_reach(std::string_view endpoint);

}  // namespace rayloc
