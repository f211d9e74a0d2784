#include "daemon/pipeline/paced_source.h"

#include <algorithm>
#include <thread>

namespace rayloc {

std::chrono::steady_clock::time_point Pace::due(Timestamp event) {
  const std::lock_guard lock(mutex_);
  if (!event_origin_) {
    event_origin_ = event;
    origin_ = std::chrono::steady_clock::now();
  }
  const double seconds = to_seconds(event - *event_origin_) / speed_;
  return origin_ + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                       std::chrono::duration<double>(seconds));
}

Expected<void> PacedSource::read(DatagramBatch& batch, Duration timeout) {
  batch.datagrams.clear();
  batch.ended = false;
  if (next_ == pending_.datagrams.size()) {
    if (Expected<void> read = recording_->read(pending_, timeout); !read) {
      return read;
    }
    next_ = 0;
  }
  if (next_ < pending_.datagrams.size()) {
    const auto wake = std::min(pace_->due(pending_.datagrams[next_].time),
                               std::chrono::steady_clock::now() + timeout);
    std::this_thread::sleep_until(wake);
    const auto now = std::chrono::steady_clock::now();
    while (next_ < pending_.datagrams.size() && pace_->due(pending_.datagrams[next_].time) <= now) {
      batch.datagrams.push_back(pending_.datagrams[next_++]);
    }
  }
  batch.watermark = pending_.watermark;
  for (std::size_t i = next_; i < pending_.datagrams.size(); ++i) {
    batch.watermark = std::min(batch.watermark, pending_.datagrams[i].time);
  }
  batch.ended = pending_.ended && next_ == pending_.datagrams.size();
  return {};
}

}  // namespace rayloc
