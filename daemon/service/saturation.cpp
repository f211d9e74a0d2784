#include "daemon/service/saturation.h"

#include <fmt/format.h>

namespace rayloc {

void Saturation::compare(const std::string& reason, std::uint64_t lost, Time now) {
  Queue& queue = queues_[reason];
  if (lost > queue.lost) {
    queue = {lost, now, true};
  }
  queue.lately = queue.lately && now - queue.last_loss < kLately;
}

void Saturation::look(const v1::Heartbeat& heartbeat, Time now) {
  const auto seconds = kLately.count();
  for (const v1::SourceReport& source : heartbeat.sources()) {
    const std::string& name = source.access_point();
    const v1::SourceCounters& counters = source.counters();
    compare(fmt::format("source {}: datagrams were lost before we read them in the last {} s, see "
                        "rayloc doctor",
                        name,
                        seconds),
            counters.kernel_drops(),
            now);
    compare(fmt::format("source {}: datagrams were dropped in the last {} s", name, seconds),
            counters.ring_dropped(),
            now);
    compare(fmt::format("source {}: frames were dropped in the last {} s: estimates take longer "
                        "than frames to come",
                        name,
                        seconds),
            counters.frames_dropped(),
            now);
  }
  compare(
      fmt::format("events were dropped in the last {} s: the publisher does not keep up", seconds),
      heartbeat.estimation().events_dropped(),
      now);
  compare(fmt::format("frames of CSI were not published in the last {} s: the publisher does not "
                      "keep up",
                      seconds),
          heartbeat.publisher().csi_dropped(),
          now);
}

std::vector<std::string> Saturation::reasons() const {
  std::vector<std::string> reasons;
  for (const auto& [reason, queue] : queues_) {
    if (queue.lately) {
      reasons.push_back(reason);
    }
  }
  return reasons;
}

}  // namespace rayloc
