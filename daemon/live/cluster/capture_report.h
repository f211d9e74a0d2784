// Counters of the batches that a capture node sends to its cluster, for heartbeats.
#pragma once

#include "daemon/live/cluster/batch_sender.h"

namespace rayloc::v1 {
class CaptureCounters;
}  // namespace rayloc::v1

namespace rayloc {

void fill_capture(const BatchSender& sender, v1::CaptureCounters& report);

}  // namespace rayloc
