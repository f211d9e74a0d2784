// Reads the frames of a recording in sequence, for verbs that need every frame and no pipeline.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "capture/assemble/csi_receiver.h"
#include "capture/source/recorded_source.h"
#include "daemon/lab/recordings/capture_argument.h"
#include "daemon/site/model/site.h"
#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"

namespace rayloc {

// `recording.access_point` is one of the site's (resolve_captures). Frames are visited
// in the order of the files, and in each in that of its packets; their times are those
// of the stamps. `notes` gets a line for each event that people should be informed of:
// clock steps, gaps, the number of packets rejected by reason, and each change of the
// channel. Errors: a file that cannot be read as a capture; one without a frame
// because it is of another channel than the site's, or of several access points.
Expected<void> for_each_frame(const Site& site,
                              const RecordingArgument& recording,
                              const std::function<void(CsiFrame&&)>& take,
                              std::vector<std::string>& notes);

// Number of packets that a receiver rejected for an address that no device has.
std::uint64_t addresses_refused(const CsiReceiverCounters& decoded);

// Adds the notes of a completely read recording, with its access point, or empty.
void note_recording(const RecordedSource& source,
                    const CsiReceiverCounters& decoded,
                    const std::string& access_point,
                    std::vector<std::string>& notes);

// Keeps the frames of the transmitter received most often (of equals the first by address) and
// returns it. Empty if there was only one or none.
std::optional<MacAddress> keep_most_received(std::vector<CsiFrame>& frames);

}  // namespace rayloc
