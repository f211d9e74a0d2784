// The frames of a site's fixed transmitters in recordings.
#pragma once

#include <map>
#include <vector>

#include "daemon/cli/capture_argument.h"
#include "daemon/site/site.h"
#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"

namespace rayloc::cli {

// By transmitter; of each, by capture and then by time. Frames of others are left out.
Expected<std::map<MacAddress, std::vector<CsiFrame>>> read_fixed_frames(
    const Site& site, const std::vector<CaptureArgument>& captures);

}  // namespace rayloc::cli
