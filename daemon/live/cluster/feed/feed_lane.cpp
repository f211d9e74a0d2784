#include "daemon/live/cluster/feed/feed_lane.h"

#include <sys/eventfd.h>

#include <utility>

namespace rayloc {

FeedLane::FeedLane(std::shared_ptr<std::atomic<std::size_t>> bytes)
    : input_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)), bytes_(std::move(bytes)) {}

void FeedLane::put(DatagramRing::Piece piece, Timestamp promised) {
  {
    const std::lock_guard lock(mutex_);
    promised_ = promised;
    if (!piece.entries.empty()) {
      *bytes_ += piece.payloads.size();
      waiting_.push_back({std::move(piece), promised, false});
      signal();
    }
  }
  wake_.notify_one();
}

void FeedLane::count_rejected(const std::string& reason, std::uint64_t datagrams) {
  if (datagrams > 0) {
    const std::lock_guard lock(mutex_);
    counters_.received += datagrams;
    counters_.rejected[reason] += datagrams;
  }
}

bool FeedLane::empty() const {
  const std::lock_guard lock(mutex_);
  return waiting_.empty();
}

void FeedLane::end(bool give_what_waits) {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    if (!give_what_waits) {
      waiting_.clear();
    }
    signal();
  }
  wake_.notify_one();
}

FeedLane::Waiting FeedLane::take(Duration timeout) {
  std::unique_lock lock(mutex_);
  wake_.wait_for(lock, timeout, [&] { return ended_ || !waiting_.empty(); });
  if (waiting_.empty()) {
    return {{}, promised_, ended_};
  }
  Waiting first = std::move(waiting_.front());
  waiting_.pop_front();
  if (waiting_.empty() && !ended_) {
    eventfd_t ignored = 0;
    (void)::eventfd_read(input_.get(), &ignored);
  }
  *bytes_ -= first.piece.payloads.size();
  counters_.received += first.piece.entries.size();
  counters_.delivered += first.piece.entries.size();
  counters_.bytes += first.piece.payloads.size();
  return first;
}

SourceCounters FeedLane::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

void FeedLane::signal() const { (void)::eventfd_write(input_.get(), 1); }

FeedSource::FeedSource(std::shared_ptr<FeedLane> lane,
                       std::shared_ptr<Broker> broker,
                       std::string description)
    : lane_(std::move(lane)), broker_(std::move(broker)), description_(std::move(description)) {}

Expected<void> FeedSource::read(DatagramBatch& batch, Duration timeout) {
  FeedLane::Waiting next = lane_->take(timeout);
  current_ = std::move(next.piece);
  batch = {};
  batch.datagrams = current_.datagrams();
  batch.watermark = next.watermark;
  batch.ended = next.ended;
  return {};
}

}  // namespace rayloc
