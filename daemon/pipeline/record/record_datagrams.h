// Records the datagrams of a source to a sink until a limit, a stop or the end of the source.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "capture/transport/datagram_sink.h"
#include "capture/transport/datagram_source.h"
#include "engine/base/expected.h"

namespace rayloc {

struct DatagramLimits {
  std::optional<double> duration = {};      // s
  std::optional<std::uint64_t> count = {};  // datagrams
};

// REQUIRES: both are set.
struct RecordEvents {
  // Called every 0.1 s or more often; true ends the recording.
  std::function<bool()> is_stopped;
  // A batch could not be written: called at once, then every ten seconds while it persists.
  std::function<void(const Error&)> on_write_error;
};

// An Error of the source ends the recording; one of the sink does not: space may become free. Calls
// the functions on this thread.
Expected<void> record_datagrams(DatagramSource& source,
                                DatagramSink& sink,
                                const DatagramLimits& limits,
                                const RecordEvents& events);

}  // namespace rayloc
