// What a worker has read of the stream of a site, as heartbeats tell it.
#pragma once

#include "daemon/cluster/site_feed.h"

namespace rayloc::v1 {
class StreamCounters;
}  // namespace rayloc::v1

namespace rayloc {

void fill_feed(const SiteFeed& feed, v1::StreamCounters& report);

}  // namespace rayloc
