// Addresses as the configuration writes them.
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

// "0.0.0.0:5500"; "*" and nothing stand for every address, "localhost" for 127.0.0.1. Else numeric,
// so that a start does not depend on a name server.
std::optional<ListenAddress> parse_listen(std::string_view text);

// Why it cannot be parsed, to follow the name of a key: "is no ADDRESS:PORT".
std::string listen_fault(std::string_view text);

// Whether an address of this machine, or "localhost", reaches this machine only.
bool is_loopback(const std::string& host);

// Whether two UDP sockets could not both be bound.
bool same_port(const ListenAddress& a, const ListenAddress& b);

// Where a ZeroMQ endpoint that we bind can be reached from.
enum class EndpointReach {
  kInvalid,   // neither tcp://HOST:PORT nor ipc://PATH
  kNamed,     // of a host or an interface by its name, which nobody here resolves
  kLoopback,  // this machine only
  kNetwork,   // other machines as well
};
EndpointReach endpoint_reach(std::string_view endpoint);

}  // namespace rayloc
