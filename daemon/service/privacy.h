// [privacy] of the configuration: what devices are called in all that leaves the daemon.
#pragma once

#include <memory>
#include <string>

#include "daemon/config/config.h"
#include "daemon/publish/target_names.h"
#include "daemon/site/site.h"
#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"

namespace rayloc {

// Reads the key, where there is one; warns in the log that recordings hold addresses, where devices
// are to be hashed and recordings are made. kConfiguration when the key cannot be used.
Expected<std::shared_ptr<TargetNames>> open_target_names(const DaemonConfig& config);

// The transmitter of a published frame: with hashes, a fixed one by its name in site.toml, which is
// nobody's.
std::string transmitter_name(const Site& site, const CsiFrame& frame, TargetNames& names);

}  // namespace rayloc
