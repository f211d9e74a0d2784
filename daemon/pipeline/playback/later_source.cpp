#include "daemon/pipeline/playback/later_source.h"

#include <vector>

namespace rayloc {

Expected<void> LaterSource::read(DatagramBatch& batch, Duration timeout) {
  Expected<void> read = recording_->read(batch, timeout);
  if (!read) {
    return read;
  }
  std::uint64_t bytes = 0;
  const auto left_out = std::erase_if(batch.datagrams, [&](const Datagram& datagram) {
    const bool is_before = datagram.time < from_;
    bytes += is_before ? datagram.payload.size() : 0U;
    return is_before;
  });
  left_out_ += left_out;
  left_out_bytes_ += bytes;
  return {};
}

SourceCounters LaterSource::counters() const {
  SourceCounters counters = recording_->counters();
  if (const std::uint64_t left_out = left_out_; left_out > 0) {
    counters.delivered -= left_out;
    counters.bytes -= left_out_bytes_;
    counters.rejected["before_the_start"] += left_out;
  }
  return counters;
}

}  // namespace rayloc
