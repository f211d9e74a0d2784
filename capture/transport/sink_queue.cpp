#include "capture/transport/sink_queue.h"

#include <algorithm>

#include "engine/base/check.h"

namespace rayloc {

Expected<void> SinkQueue::queue(std::size_t sink, const Datagram& datagram) {
  RAYLOC_CHECK(sink < sinks_.size());
  queued_.push_back({sink, datagram, datagram.payload.size()});
  payloads_.insert(payloads_.end(), datagram.payload.begin(), datagram.payload.end());
  return queued_.size() == kBatch ? flush() : Expected<void>();
}

Expected<void> SinkQueue::flush() {
  std::vector<DatagramBatch> batches(sinks_.size());
  std::size_t at = 0;
  for (Queued& one : queued_) {
    one.datagram.payload = std::span(payloads_).subspan(at, one.size);
    at += one.size;
    DatagramBatch& batch = batches[one.sink];
    batch.datagrams.push_back(one.datagram);
    batch.watermark = std::max(batch.watermark, one.datagram.time);
  }
  Expected<void> result;
  for (std::size_t i = 0; i < batches.size() && result; ++i) {
    if (!batches[i].datagrams.empty()) {
      result = sinks_[i]->write(batches[i]);
    }
  }
  queued_.clear();
  payloads_.clear();
  return result;
}

Expected<void> SinkQueue::sync() {
  Expected<void> result = flush();
  for (const auto& sink : sinks_) {
    if (auto synced = sink->sync(); result && !synced) {
      result = synced;
    }
  }
  return result;
}

SinkCounters SinkQueue::counters() const {
  SinkCounters all;
  for (const auto& sink : sinks_) {
    const SinkCounters& one = sink->counters();
    all.given += one.given;
    all.delivered += one.delivered;
    all.bytes += one.bytes;
    all.errors += one.errors;
    for (const auto& [reason, count] : one.lost_by) {
      all.lost_by[reason] += count;
    }
  }
  return all;
}

}  // namespace rayloc
