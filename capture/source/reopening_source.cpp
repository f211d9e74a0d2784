#include "capture/source/reopening_source.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace rayloc {

Expected<std::unique_ptr<ReopeningSource>> ReopeningSource::open(Open open,
                                                                 std::function<Time()> now) {
  Expected<std::unique_ptr<DatagramSource>> source = open();
  RAYLOC_TRY(source);
  return std::unique_ptr<ReopeningSource>(
      new ReopeningSource(std::move(open), std::move(now), std::move(*source)));
}

ReopeningSource::ReopeningSource(Open open,
                                 std::function<Time()> now,
                                 std::unique_ptr<DatagramSource> source)
    : open_(std::move(open)),
      now_(std::move(now)),
      description_(source->description()),
      opened_(now_()),
      source_(std::move(source)) {}

Expected<void> ReopeningSource::read(DatagramBatch& batch, Duration timeout) {
  clock_.observe_now();
  {
    const std::lock_guard lock(mutex_);
    before_.clock_steps = clock_.steps();
  }
  if (!source_ && !reopen()) {
    read_closed(batch, timeout);
    return {};
  }
  if (const Expected<void> read = source_->read(batch, timeout); !read) {
    close(read.error());
    read_closed(batch, Duration::zero());
    return {};
  }
  keep_promises(batch);
  return {};
}

// Returns the advancing time while the source is closed.
void ReopeningSource::read_closed(DatagramBatch& batch, Duration timeout) {
  batch = {};
  if (timeout > Duration::zero()) {
    std::this_thread::sleep_for(std::min<Duration>(timeout, next_try_ - now_()));
  }
  clock_.observe_now();
  clock_.drained();
  watermark_ = std::max(watermark_, clock_.watermark());
  batch.watermark = watermark_;
}

// A newly opened source may have an earlier watermark than was returned while it was closed.
void ReopeningSource::keep_promises(DatagramBatch& batch) {
  for (Datagram& datagram : batch.datagrams) {
    datagram.time = std::max(datagram.time, watermark_);
  }
  watermark_ = std::max(watermark_, batch.watermark);
  batch.watermark = watermark_;
}

bool ReopeningSource::reopen() {
  if (now_() < next_try_) {
    return false;
  }
  Expected<std::unique_ptr<DatagramSource>> opened = open_();
  if (!opened) {
    try_later(opened.error());
    return false;
  }
  opened_ = now_();
  trouble_.clear();
  const std::lock_guard lock(mutex_);
  source_ = std::move(*opened);
  return true;
}

void ReopeningSource::close(const Error& why) {
  if (now_() - opened_ >= kLongestWait) {
    wait_ = kShortestWait;
  }
  try_later(why);
  const std::lock_guard lock(mutex_);
  add_counts(before_, source_->counters());
  ++before_.failures;
  source_.reset();
}

void ReopeningSource::try_later(const Error& why) {
  trouble_ = why.message;
  next_try_ = now_() + wait_;
  wait_ = std::min(2 * wait_, kLongestWait);
}

SourceCounters ReopeningSource::counters() const {
  const std::lock_guard lock(mutex_);
  SourceCounters all = before_;
  if (source_) {
    add_counts(all, source_->counters());
  }
  return all;
}

}  // namespace rayloc
