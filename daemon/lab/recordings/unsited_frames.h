// Reads the frames of a recording without a site: every access point and format is accepted.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capture/assemble/csi_receiver.h"
#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/lab/recordings/frame_summary.h"
#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"

namespace rayloc {

// The access point of the recording, or its first file if none is stated.
std::string recording_name(const RecordingArgument& recording);

// `take` gets the frames of each batch, in the order of the packets, and may move them; an Error of
// it ends the reading at once, without a summary. Adds the outcome to `summary`, and a line to
// `notes` for each event that people should be informed of. Errors: a file that cannot be read as a
// capture; the frames and the outcome before it are reported as well.
Expected<void> read_unsited_frames(
    const RecordingArgument& recording,
    const CsiReceiverOptions& options,
    const std::function<Expected<void>(std::vector<CsiFrame>& frames)>& take,
    FrameSummary& summary,
    std::vector<std::string>& notes);

// Returns an Error (kUsage) that lists the formats if there is none of this name. Empty: any.
Expected<void> check_wire_format(const std::string& format);

// Returns an Error if packets contain no CSI at all.
Expected<void> check_summary(const FrameSummary& summary);

}  // namespace rayloc
