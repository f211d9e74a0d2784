// Frames of a site's fixed transmitters from recordings.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"

namespace rayloc {

// By transmitter, each sorted by access point and then by time. Frames of others are left out. An
// access point may have several captures; `notes` as in for_each_frame().
Expected<std::map<MacAddress, std::vector<CsiFrame>>> read_fixed_frames(
    const Site& site,
    const std::vector<CaptureArgument>& captures,
    std::vector<std::string>& notes);

}  // namespace rayloc
