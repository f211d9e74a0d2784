// Data that a NATS server sends before a client has identified itself.
#pragma once

#include <chrono>
#include <string>

#include "engine/base/expected.h"

namespace rayloc {

struct ServerGreeting {
  std::string version;  // "2.9.10"
  std::string cluster;  // its name; empty: a single server
  bool jetstream = false;
  bool asks_for_tls = false;
  bool asks_who = false;  // requires a key, a name or a token
};

// `server`: "nats://HOST:PORT" or "tls://HOST:PORT".
Expected<ServerGreeting> greeting_of(const std::string& server, std::chrono::milliseconds patience);

}  // namespace rayloc
