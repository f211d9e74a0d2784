// ReceiverPool: a bounded number of threads that read the live sources of all sites. Each thread
// polls the descriptors of its readers. In each round every reader with input takes one bounded
// part of it, so a flooded one delays the others by its part only. At each tick all readers take a
// step, with or without input, since event time advances without datagrams. Recorders, which have
// no descriptor, take their steps at ticks only.
//
// Thread safety: any thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "daemon/pipeline/shared/polled_reader.h"

namespace rayloc {

class ReceiverPool {
 public:
  struct Options {
    std::size_t most_threads = 1;  // each is started when a reader needs it
    // The resolution of event time while no data arrive.
    std::chrono::milliseconds tick{20};
    const char* name = "receiver";  // of the threads, for top -H; a literal
  };
  explicit ReceiverPool(const Options& options);
  // REQUIRES: every reader has ended.
  ~ReceiverPool();
  ReceiverPool(const ReceiverPool&) = delete;
  ReceiverPool& operator=(const ReceiverPool&) = delete;

  // Begins to read it, on the thread with the fewest readers.
  void add(PolledReader& reader);
  // Lets the reader take a step at once, so that one that was asked to end does; returns when it
  // has ended and is not used any more. REQUIRES: it was added.
  void wait_for_end(PolledReader& reader);

  std::size_t threads() const;

 private:
  class Receiver;
  const Options options_;
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<Receiver>> receivers_;  // guarded by mutex_
};

}  // namespace rayloc
