// SourceWorker: the receiving thread of one access point: reads datagrams, hands a copy to the
// recorder, decodes and assembles them, and leaves the frames in the mailbox.
//
// Thread safety: start(), stop() and join() from one thread, report() from any.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "capture/csi_receiver.h"
#include "capture/datagram_source.h"
#include "daemon/pipeline/frame_mailbox.h"

namespace rayloc {

// Sees every datagram that a source delivers, before it is decoded.
class DatagramTap {
 public:
  virtual ~DatagramTap() = default;
  virtual void tap(std::span<const Datagram> datagrams) = 0;
};

// What a source has done so far; one consistent snapshot.
struct SourceReport {
  std::string access_point;
  std::string description;
  SourceCounters source;
  CsiReceiverCounters receiver;
  Timestamp last_datagram{};  // event time; the epoch when none came
  bool ended = false;
  std::string error;  // why it ended before its time, empty otherwise
};

class SourceWorker {
 public:
  struct Input {
    std::string access_point;  // id
    std::unique_ptr<DatagramSource> source;
    CsiReceiverOptions receiver;
    DatagramTap* tap = nullptr;  // may be null; outlives the worker
  };

  // `slot`: the source's number in `mailbox`, which outlives the worker.
  SourceWorker(Input input, FrameMailbox& mailbox, std::size_t slot);
  ~SourceWorker();
  SourceWorker(const SourceWorker&) = delete;
  SourceWorker& operator=(const SourceWorker&) = delete;

  void start();
  // Asks the thread to end: it takes what has already arrived, decodes it and leaves.
  void stop() { stopping_ = true; }
  void join();

  SourceReport report() const;

 private:
  void run();
  bool step(DatagramBatch& batch, std::vector<CsiFrame>& frames, Duration timeout);
  void publish_report(const DatagramBatch& batch);

  std::unique_ptr<DatagramSource> source_;
  CsiReceiver receiver_;
  FrameMailbox& mailbox_;
  const std::size_t slot_;
  DatagramTap* const tap_;
  std::atomic<bool> stopping_ = false;
  mutable std::mutex mutex_;
  SourceReport report_;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace rayloc
