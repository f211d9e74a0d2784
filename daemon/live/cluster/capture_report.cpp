#include "daemon/live/cluster/capture_report.h"

#include "rayloc/v1/heartbeat.pb.h"

namespace rayloc {

void fill_capture(const BatchSender& sender, v1::CaptureCounters& report) {
  BatchSender::Counters counters = sender.counters();
  NumberedRing::Counters& ring = counters.ring;
  report.set_connected(counters.connected);
  for (const auto& [access_point, captured] : counters.captured) {
    v1::BatchCounters& one = *report.add_access_points();
    one.set_access_point(access_point);
    one.set_captured(captured);
    one.set_in_batches(ring.live[access_point]);
    one.set_in_gap_marks(ring.marked[access_point]);
    one.set_waiting(ring.waiting[access_point]);
  }
  report.set_batches(ring.batches);
  report.set_sent(ring.sent);
  report.set_repeated(ring.repeated);
  report.set_asked_for(ring.asked_for);
  report.set_refused(counters.refused);
  report.set_marked(ring.marked_batches);
  report.set_unacknowledged(ring.unacknowledged);
  report.set_kept(ring.kept);
  report.set_kept_bytes(ring.kept_bytes);
}

}  // namespace rayloc
