// FeedLane: queue of the datagrams of one access point between the thread that reads a site's
// stream and the source that its pipeline reads.
//
// Thread safety: `node` and `watermark` are for the thread of the feed; take() is for the source.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "capture/transport/datagram_source.h"
#include "capture/transport/file_descriptor.h"
#include "daemon/live/cluster/broker.h"
#include "daemon/pipeline/record/datagram_ring.h"

namespace rayloc {

class FeedLane {
 public:
  // `bytes`: size of the queued data of all lanes.
  explicit FeedLane(std::shared_ptr<std::atomic<std::size_t>> bytes);

  // Node that last received the access point; empty: none has named it yet. For the feed alone.
  std::string node;
  // Last promised watermark. For the feed alone.
  Timestamp watermark = Timestamp::min();

  void put(DatagramRing::Piece piece, Timestamp promised);
  void count_rejected(const std::string& reason, std::uint64_t datagrams);
  bool empty() const;
  // Ends the input; queued data are delivered only with `give_what_waits`.
  void end(bool give_what_waits);

  struct Waiting {
    DatagramRing::Piece piece;
    Timestamp watermark;
    bool ended = false;
  };
  // Waits for data; on a time-out returns the promised watermark.
  Waiting take(Duration timeout);
  // Readable while data wait, and from the end on.
  int descriptor() const { return input_.get(); }
  SourceCounters counters() const;

 private:
  void signal() const;

  const FileDescriptor input_;
  const std::shared_ptr<std::atomic<std::size_t>> bytes_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Waiting> waiting_;            // guarded by mutex_
  Timestamp promised_ = Timestamp::min();  // guarded by mutex_
  bool ended_ = false;                     // guarded by mutex_
  SourceCounters counters_;                // guarded by mutex_
};

// Source of an access point: its lane, whose trouble is an absent broker.
class FeedSource final : public DatagramSource {
 public:
  FeedSource(std::shared_ptr<FeedLane> lane,
             std::shared_ptr<Broker> broker,
             std::string description);

  Expected<void> read(DatagramBatch& batch, Duration timeout) override;
  SourceCounters counters() const override { return lane_->counters(); }
  std::string description() const override { return description_; }
  std::optional<int> poll_descriptor() const override { return lane_->descriptor(); }
  std::string trouble() const override { return broker_->connected() ? "" : "no broker answers"; }

 private:
  const std::shared_ptr<FeedLane> lane_;
  const std::shared_ptr<Broker> broker_;
  const std::string description_;
  DatagramRing::Piece current_;
};

}  // namespace rayloc
