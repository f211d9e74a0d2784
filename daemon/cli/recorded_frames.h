// The frames of a recording, one after the other: for verbs that look at each and need no pipeline.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "daemon/cli/capture_argument.h"
#include "daemon/site/site.h"
#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"

namespace rayloc::cli {

// `capture.access_point` is one of the site's (resolve_captures). Frames come in the order of the
// recording's times, whatever that of its packets. Errors: a file that cannot be read as a capture.
Expected<void> for_each_frame(const Site& site,
                              const CaptureArgument& capture,
                              const std::function<void(CsiFrame&&)>& take);

// Of frames of several transmitters those of the one heard most stay (of equals the first by
// address); which one that is. Nothing when there was no choice to make.
std::optional<MacAddress> keep_most_heard(std::vector<CsiFrame>& frames);

}  // namespace rayloc::cli
