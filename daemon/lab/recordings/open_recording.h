// open_recording: the datagrams of a `[AP=]FILE` argument.
#pragma once

#include <memory>

#include "capture/transport/datagram_source.h"
#include "capture/transport/transport_scheme.h"
#include "daemon/lab/recordings/capture_argument.h"
#include "engine/base/expected.h"

namespace rayloc {

// A sequence of files is one recording; so is the content of other transports. An Error (kUsage)
// for a live transport, or for one that cannot be a part of a sequence.
Expected<std::unique_ptr<DatagramSource>> open_recording(const RecordingArgument& recording,
                                                         const SourceOptions& options);

}  // namespace rayloc
