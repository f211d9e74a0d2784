// Messages of `rayloc record`: the state of its source, and the summary of a recording.
#pragma once

#include "capture/transport/datagram_sink.h"
#include "capture/transport/datagram_source.h"

namespace rayloc::cli {

// Prints the notices of a source that was opened, and a receive buffer that is too small, to
// standard error.
void report_source(const DatagramSource& source);

// Prints the counters as a line of JSON to standard output, and the reasons for rejected packets to
// standard error.
void report_recorded(const DatagramSource& source, const DatagramSink& recorder);

}  // namespace rayloc::cli
