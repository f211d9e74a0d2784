// The frames of a recording, one after the other: for verbs that look at each and need no pipeline.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "capture/assemble/csi_receiver.h"
#include "capture/source/recorded_source.h"
#include "daemon/arguments/capture_argument.h"
#include "daemon/site/site.h"
#include "engine/base/expected.h"
#include "engine/channel/csi_frame.h"

namespace rayloc::cli {

// `recording.access_point` is one of the site's (resolve_captures). Frames come in the order of the
// files, and in each in that of its packets; their times are those of the stamps. `notes` gets a
// line for everything that people should know: clocks that were set, gaps, how many packets were
// rejected for which reason, and each change of the channel. Errors: a file that cannot be read as
// a capture; one without a frame since it is of another channel than the site's, or of several
// access points.
Expected<void> for_each_frame(const Site& site,
                              const RecordingArgument& recording,
                              const std::function<void(CsiFrame&&)>& take,
                              std::vector<std::string>& notes);

// Packets that a receiver rejected for an address that no device has.
std::uint64_t addresses_refused(const CsiReceiverCounters& decoded);

// The notes of a recording that was read to its end; of which access point, or empty.
void note_recording(const RecordedSource& source,
                    const CsiReceiverCounters& decoded,
                    const std::string& access_point,
                    std::vector<std::string>& notes);

// Of frames of several transmitters those of the one heard most stay (of equals the first by
// address); which one that is. Nothing when there was no choice to make.
std::optional<MacAddress> keep_most_heard(std::vector<CsiFrame>& frames);

}  // namespace rayloc::cli
