// ReceiverPool: a bounded number of threads that read the live sources of all sites. Each thread
// polls the descriptors of its readers. In each round every reader with input takes one bounded
// part of it, so a flooded one delays the others by its part only. Every 20 ms all readers take a
// step, with or without input, since event time advances without datagrams.
//
// Thread safety: any thread.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "daemon/pipeline/shared/polled_reader.h"

namespace rayloc {

class ReceiverPool {
 public:
  // At most so many threads, each started when a reader needs it.
  explicit ReceiverPool(std::size_t most_threads);
  // REQUIRES: every reader has ended.
  ~ReceiverPool();
  ReceiverPool(const ReceiverPool&) = delete;
  ReceiverPool& operator=(const ReceiverPool&) = delete;

  // Begins to read it, on the thread with the fewest readers.
  void add(PolledReader& reader);
  // Returns when the reader has ended and is not used any more. REQUIRES: it was added.
  void wait_for_end(PolledReader& reader);

  std::size_t threads() const;

 private:
  class Receiver;
  const std::size_t most_threads_;
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<Receiver>> receivers_;  // guarded by mutex_
};

}  // namespace rayloc
