// Checks that the ports, paths and interfaces of a configuration are available, before the room is
// prepared: a second daemon for the same ports ends immediately, not minutes later.
#pragma once

#include "daemon/live/config/config.h"
#include "daemon/live/service/service_manager.h"
#include "engine/base/expected.h"

namespace rayloc {

// Each is opened for an instant, except those that systemd passes; datagrams that arrive meanwhile
// are lost as before the start. The error is the same as for opening it permanently.
Expected<void> check_places(const DaemonConfig& config, const PassedSockets& sockets);

}  // namespace rayloc
