// A listening TCP socket for a ZeroMQ endpoint.
//
// libzmq 4.3.4 queries the kernel for the interfaces of the machine by AF_NETLINK before it binds
// an address, and aborts if a sandbox denies that (RestrictAddressFamilies= of our unit). It
// accepts a bound socket without that query (ZMQ_USE_FD).
#pragma once

#include <optional>
#include <string>

namespace rayloc {

// Supports "tcp://ADDRESS:PORT" with a numeric address, "localhost" (127.0.0.1) or "*", and a
// number or "*" as the port. Empty for other endpoints: ipc://, which libzmq binds, and names of
// hosts and interfaces, which must not reach it. -1 with errno if the address cannot be bound.
std::optional<int> listen_on_tcp(const std::string& endpoint);

}  // namespace rayloc
