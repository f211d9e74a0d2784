// A listening TCP socket for a ZeroMQ endpoint.
//
// libzmq 4.3.4 asks the kernel for the interfaces of the machine by AF_NETLINK before it binds an
// address, and aborts where a sandbox denies that (RestrictAddressFamilies= of our unit). A socket
// that is bound already it takes as it is (ZMQ_USE_FD).
#pragma once

#include <optional>
#include <string>

namespace rayloc {

// Of "tcp://ADDRESS:PORT" with a numeric address, "localhost" (127.0.0.1) or "*", and a number or
// "*" as the port. Nothing for other endpoints: ipc://, which libzmq binds, and names of hosts and
// interfaces, which it must not be given. -1 with errno when the address cannot be bound.
std::optional<int> listen_on_tcp(const std::string& endpoint);

}  // namespace rayloc
