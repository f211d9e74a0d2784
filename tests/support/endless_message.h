// A ZeroMQ message without an end, written to a socket as raw bytes of the protocol (RFC 23, NULL).
#pragma once

#include <cstddef>
#include <string>

namespace rayloc {

// Connects to "tcp://127.0.0.1:PORT" as a socket of `type` ("DEALER", "SUB"), and sends parts of
// `part_bytes` of one message until the connection is reset or `most_bytes` are sent. Returns the
// number of bytes sent.
std::size_t send_endless_message(const std::string& endpoint,
                                 const std::string& type,
                                 std::size_t part_bytes,
                                 std::size_t most_bytes);

}  // namespace rayloc
