// SourceWorker: the receiving thread of one access point: it drives a SourceLane until the source
// ends, or a stop is requested.
//
// Thread safety: start(), stop() and join() from one thread, report() from any.
#pragma once

#include <atomic>
#include <thread>

#include "daemon/pipeline/source_lane.h"

namespace rayloc {

class SourceWorker {
 public:
  using Input = SourceInput;

  // `slot`: the source's number in `mailbox`, which outlives the worker.
  SourceWorker(Input input, FrameMailbox& mailbox, std::size_t slot);
  ~SourceWorker();
  SourceWorker(const SourceWorker&) = delete;
  SourceWorker& operator=(const SourceWorker&) = delete;

  void start();
  // Asks the thread to end: it decodes the datagrams that have already arrived and ends.
  void stop() { stopping_ = true; }
  void join();
  // The datagram source, with its open port. REQUIRES: joined.
  std::unique_ptr<DatagramSource> release() { return lane_.release(); }

  SourceReport report() const { return lane_.report(); }
  const StageProgress& progress() const { return lane_.progress(); }

 private:
  void run();

  SourceLane lane_;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace rayloc
