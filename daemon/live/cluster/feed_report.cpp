#include "daemon/live/cluster/feed_report.h"

#include "rayloc/v1/heartbeat.pb.h"

namespace rayloc {

void fill_feed(const SiteFeed& feed, v1::StreamCounters& report) {
  const SiteFeed::Counters counters = feed.counters();
  report.set_messages(counters.stream.read);
  report.set_fetched(counters.stream.asked_for);
  report.set_lost(counters.stream.lost);
  report.set_restarts(counters.stream.streams);
  report.set_batches(counters.batches.pushed);
  report.set_taken(counters.batches.taken);
  report.set_repeats(counters.batches.repeats);
  report.set_late(counters.batches.late);
  report.set_held(counters.batches.held);
  report.set_marked(counters.batches.marked);
  report.set_missing(counters.batches.missing);
  report.mutable_marked_datagrams()->insert(counters.batches.marked_datagrams.begin(),
                                            counters.batches.marked_datagrams.end());
  report.set_refused(counters.refused);
  report.set_unknown(counters.unknown);
  report.set_silences(counters.silences);
}

}  // namespace rayloc
