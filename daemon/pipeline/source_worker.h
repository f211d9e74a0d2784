// SourceWorker: reads one access point: it drives a SourceLane until the source ends, or a stop is
// requested. It has a thread of its own, or shares those of a ReceiverPool.
//
// Thread safety: start(), stop() and join() from one thread, report() from any.
#pragma once

#include <atomic>
#include <thread>

#include "daemon/pipeline/shared/polled_reader.h"
#include "daemon/pipeline/source_lane.h"

namespace rayloc {

class ReceiverPool;

class SourceWorker : private PolledReader {
 public:
  using Input = SourceInput;

  // `slot`: the source's number in `mailbox`, which outlives the worker.
  SourceWorker(Input input, FrameMailbox& mailbox, std::size_t slot);
  ~SourceWorker() override;
  SourceWorker(const SourceWorker&) = delete;
  SourceWorker& operator=(const SourceWorker&) = delete;

  // `receivers` (may be null, outlives the worker): read a source that has a descriptor.
  void start(ReceiverPool* receivers);
  // Requests the end: the datagrams that have already arrived are still decoded.
  void stop() { stopping_ = true; }
  void join();
  // The datagram source, with its open port. REQUIRES: joined.
  std::unique_ptr<DatagramSource> release() { return lane_.release(); }

  SourceReport report() const { return lane_.report(); }
  const StageProgress& progress() const { return lane_.progress(); }
  // REQUIRES: started.
  bool has_shared_thread() const { return receivers_ != nullptr; }

 private:
  void run();
  // While the mailbox has no room, the input stays where it is until a later tick.
  int descriptor() const override {
    return lane_.has_room() ? lane_.poll_descriptor().value_or(-1) : -1;
  }
  bool read_once() override;
  bool may_have_more() const override { return !lane_.was_idle() && lane_.has_room(); }
  bool drain_once();

  SourceLane lane_;
  std::atomic<bool> stopping_ = false;
  int reads_after_stop_ = 0;
  ReceiverPool* receivers_ = nullptr;  // that read it; null: none
  std::thread thread_;
};

}  // namespace rayloc
