// Whether the ports, paths and interfaces of a configuration can be had, asked before the room is
// prepared: a second daemon in the place of the first ends at once, not minutes later.
#pragma once

#include "daemon/config/config.h"
#include "daemon/service/service_manager.h"
#include "engine/base/expected.h"

namespace rayloc {

// Each is had for an instant, but for those that systemd passes; what comes to it meanwhile is lost
// as if nobody were there yet. The error is that of taking it for good.
Expected<void> check_places(const DaemonConfig& config, const PassedSockets& sockets);

}  // namespace rayloc
