// Connections that violate the protocol of the server that they reach, for tests of the effects
// on other clients.
#pragma once

#include <random>
#include <string>

namespace rayloc {

// A connection to "tcp://127.0.0.1:PORT" or "ipc://PATH" that sends arbitrary bytes, and nothing
// more until it is destroyed.
class HostileClient {
 public:
  HostileClient(const std::string& endpoint, const std::string& bytes);
  HostileClient(HostileClient&& other) noexcept;
  HostileClient(const HostileClient&) = delete;
  HostileClient& operator=(const HostileClient&) = delete;
  HostileClient& operator=(HostileClient&&) = delete;
  ~HostileClient();

 private:
  int fd_;
};

// The greeting of ZMTP 3 (RFC 23) and commands of CURVE and NULL with random contents,
// complete, truncated, or with bytes changed.
std::string hostile_handshake(std::mt19937& random);

// The same for a request of HTTP/1.1.
std::string hostile_request(std::mt19937& random);

}  // namespace rayloc
