// Counters of the site stream that a worker reads, for heartbeats.
#pragma once

#include "daemon/live/cluster/site_feed.h"

namespace rayloc::v1 {
class StreamCounters;
}  // namespace rayloc::v1

namespace rayloc {

void fill_feed(const SiteFeed& feed, v1::StreamCounters& report);

}  // namespace rayloc
