// DatagramRing: the last half a minute of the datagrams of one source, in memory, to be written
// after a fault (ring_snapshots.h).
//
// Bounded in time (that of the datagrams) and in bytes: the oldest datagrams are removed, in pieces
// of about 64 KiB. Thread safety: tap() from one thread, contents() from any; neither waits for
// more than the copying of a batch.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "capture/transport/datagram.h"
#include "daemon/pipeline/source_worker.h"

namespace rayloc {

class DatagramRing : public DatagramTap {
 public:
  DatagramRing(Duration length, std::size_t max_bytes) : length_(length), max_bytes_(max_bytes) {}

  void tap(std::span<const Datagram> datagrams) override;
  // Clears the ring: files are in order of time.
  void moved() override;

  // Consecutive datagrams, with contiguous payloads.
  struct Piece {
    struct Entry {
      Timestamp time;
      DatagramAddress address;
      std::size_t size;
    };
    std::vector<Entry> entries;
    std::vector<std::byte> payloads;
    std::size_t bytes() const { return payloads.size() + entries.size() * sizeof(Entry); }
    // They point into the piece.
    std::vector<Datagram> datagrams() const;
  };
  // Its content, the oldest first; unchanged while the ring continues.
  std::vector<std::shared_ptr<const Piece>> contents();

 private:
  void seal();
  void forget(Timestamp now);

  const Duration length_;
  const std::size_t max_bytes_;
  std::mutex mutex_;
  std::deque<std::shared_ptr<const Piece>> pieces_;  // guarded by mutex_; complete ones
  Piece open_;                                       // guarded by mutex_; the newest
  std::size_t bytes_ = 0;                            // guarded by mutex_; of pieces_
};

}  // namespace rayloc
