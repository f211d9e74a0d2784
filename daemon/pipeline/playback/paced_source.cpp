#include "daemon/pipeline/playback/paced_source.h"

#include <algorithm>
#include <thread>

namespace rayloc {

std::size_t Pace::join() {
  const std::lock_guard lock(mutex_);
  next_.emplace_back();
  return next_.size() - 1;
}

void Pace::leave(std::size_t recording) {
  const std::lock_guard lock(mutex_);
  next_[recording] = Timestamp::max();
}

// REQUIRES: the mutex is held, and there is an origin.
Pace::Clock::time_point Pace::when(Timestamp event) const {
  constexpr double kLongestWait = 1e9;  // [s]: no stamp overflows
  const double seconds = std::min(to_seconds(event - *event_origin_) / speed_, kLongestWait);
  return origin_ +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

Pace::Clock::time_point Pace::due(std::size_t recording, Timestamp next) {
  const std::lock_guard lock(mutex_);
  const auto now = Clock::now();
  if (!event_origin_) {
    event_origin_ = next;
    origin_ = now;
  }
  next_[recording] = next;
  // No time is skipped in which another recording may still deliver.
  Timestamp earliest = next;
  for (const std::optional<Timestamp>& other : next_) {
    earliest = std::min(earliest, other.value_or(Timestamp::min()));
  }
  const auto longest = std::chrono::duration<double>(std::min(to_seconds(max_gap_) / speed_, 1e9));
  if (earliest != Timestamp::min() && when(earliest) - now > longest) {
    event_origin_ = earliest;
    origin_ = now + std::chrono::duration_cast<Clock::duration>(longest);
  }
  return when(next);
}

Expected<void> PacedSource::read(DatagramBatch& batch, Duration timeout) {
  batch.datagrams.clear();
  batch.ended = false;
  if (next_ == pending_.datagrams.size()) {
    if (Expected<void> read = recording_->read(pending_, timeout); !read) {
      pace_->leave(number_);
      return read;
    }
    next_ = 0;
  }
  if (next_ < pending_.datagrams.size()) {
    const auto wake = std::min(pace_->due(number_, pending_.datagrams[next_].time),
                               std::chrono::steady_clock::now() + timeout);
    std::this_thread::sleep_until(wake);
    const auto now = std::chrono::steady_clock::now();
    while (next_ < pending_.datagrams.size() &&
           pace_->due(number_, pending_.datagrams[next_].time) <= now) {
      batch.datagrams.push_back(pending_.datagrams[next_++]);
    }
  }
  batch.watermark = pending_.watermark;
  for (std::size_t i = next_; i < pending_.datagrams.size(); ++i) {
    batch.watermark = std::min(batch.watermark, pending_.datagrams[i].time);
  }
  batch.ended = pending_.ended && next_ == pending_.datagrams.size();
  if (batch.ended) {
    pace_->leave(number_);
  }
  return {};
}

}  // namespace rayloc
