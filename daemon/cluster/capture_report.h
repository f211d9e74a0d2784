// What a capture node has given to its cluster, as heartbeats tell it.
#pragma once

#include "daemon/cluster/batch_sender.h"

namespace rayloc::v1 {
class CaptureCounters;
}  // namespace rayloc::v1

namespace rayloc {

void fill_capture(const BatchSender& sender, v1::CaptureCounters& report);

}  // namespace rayloc
