// What the sockets that systemd passes must be: of the type that their names stand for, and, where
// nobody is asked who they are, bound where this machine alone reaches them. That is the rule for
// the addresses of the configuration (config.cpp), whose place a passed socket takes.
#pragma once

#include <string>

#include "daemon/config/config.h"
#include "daemon/service/service_manager.h"
#include "engine/base/expected.h"

namespace rayloc {

// Every socket that this configuration will take. kConfiguration: one is another than it must be;
// the message names its unit and what to write there.
Expected<void> check_passed_sockets(const PassedSockets& sockets, const DaemonConfig& config);

// Whether `source` takes the place of its address from a passed socket.
bool takes_socket(const SourceConfig& source);

// What one socket must be.
struct SocketDemand {
  enum class Family { kAny, kInternet, kUnix };

  std::string unit;       // that binds it: "raylocd-http.socket"
  std::string line;       // that the unit should have: "ListenStream=127.0.0.1:8480"
  bool listening = true;  // a stream socket that listens; else one for datagrams
  Family family = Family::kAny;
  // What makes it right that others reach it: "set token_file in [http]"; empty: nothing is needed.
  std::string precaution = {};
};
Expected<void> check_passed_socket(int fd, const SocketDemand& demand);

}  // namespace rayloc
