// Requirements on the sockets that systemd passes: the type must match the name, and a socket
// without authentication must be bound to an address that only this machine reaches. That is the
// rule for the addresses of the configuration (config.cpp), which a passed socket replaces.
#pragma once

#include <string>

#include "daemon/live/config/config.h"
#include "daemon/live/service/service_manager.h"
#include "engine/base/expected.h"

namespace rayloc {

// Checks every socket that this configuration will take. kConfiguration: one does not match; the
// message names its unit and the required setting.
Expected<void> check_passed_sockets(const PassedSockets& sockets, const DaemonConfig& config);

// True if a passed socket can replace the address of `source`.
bool takes_socket(const SourceConfig& source);

// Requirements on one socket.
struct SocketDemand {
  enum class Family { kAny, kInternet, kUnix };

  std::string unit;       // that binds it: "raylocd-http.socket"
  std::string line;       // that the unit should have: "ListenStream=127.0.0.1:8480"
  bool listening = true;  // a stream socket that listens; otherwise one for datagrams
  Family family = Family::kAny;
  // The setting that permits access by others: "set token_file in [http]"; empty: none is needed.
  std::string precaution = {};
};
Expected<void> check_passed_socket(int fd, const SocketDemand& demand);

}  // namespace rayloc
