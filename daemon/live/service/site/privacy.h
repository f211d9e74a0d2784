// [privacy] of the configuration: the names of devices in all output of the daemon.
#pragma once

#include <memory>
#include <string>

#include "daemon/live/config/config.h"
#include "daemon/messages/target_names.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"

namespace rayloc {

// Reads the key, if there is one; logs a warning that recordings contain addresses if devices are
// to be hashed and recordings are made. kConfiguration when the key cannot be used.
Expected<std::shared_ptr<TargetNames>> open_target_names(const DaemonConfig& config);

// The transmitter of a published frame: with hashes, a fixed one by its name in site.toml, which
// belongs to no person.
std::string transmitter_name(const Site& site, const CsiFrame& frame, TargetNames& names);

}  // namespace rayloc
