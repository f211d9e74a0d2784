// SourceWorker: the receiving thread of one access point: reads datagrams, shows them to the
// recorder and the ring, decodes and assembles them, and leaves the frames in the mailbox.
//
// Thread safety: start(), stop() and join() from one thread, report() from any.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "capture/assemble/csi_receiver.h"
#include "capture/transport/datagram_source.h"
#include "daemon/pipeline/frame_census.h"
#include "daemon/pipeline/frame_mailbox.h"
#include "daemon/pipeline/stage_progress.h"

namespace rayloc {

// Sees every datagram that a source delivers, before it is decoded.
class DatagramTap {
 public:
  virtual ~DatagramTap() = default;
  virtual void tap(std::span<const Datagram> datagrams) = 0;
  // What comes next is of another place of a recording.
  virtual void moved() {}
};

// Sees every frame that was made of them, before it is explained.
class FrameTap {
 public:
  virtual ~FrameTap() = default;
  virtual void tap(const std::string& access_point, std::span<const CsiFrame> frames) = 0;
};

// What a source has done so far; one consistent snapshot.
struct SourceReport {
  std::string access_point;
  std::string description;
  SourceCounters source;
  CsiReceiverCounters receiver;
  FrameCensus frames;
  Timestamp last_datagram{};                             // event time; the epoch when none came
  std::chrono::steady_clock::time_point last_arrival{};  // of it: nobody can set this clock
  bool ended = false;  // for good, or until a recording that is played goes on elsewhere
  // Why it ended before its time, or, of a source that goes on, why nothing can be read now; empty
  // otherwise.
  std::string error;
};

class SourceWorker {
 public:
  struct Input {
    std::string access_point;  // id
    std::unique_ptr<DatagramSource> source;
    CsiReceiverOptions receiver;
    std::vector<DatagramTap*> taps;  // outlive the worker
    FrameTap* frame_tap = nullptr;   // may be null; outlives the worker
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
  const StageProgress& progress() const { return progress_; }

 private:
  void run();
  bool step(DatagramBatch& batch, std::vector<CsiFrame>& frames, Duration timeout);
  void move(std::uint64_t number, const DatagramBatch& batch, std::vector<CsiFrame>& frames);
  void show(std::span<const CsiFrame> frames);
  void publish_report(const DatagramBatch& batch);

  std::unique_ptr<DatagramSource> source_;
  CsiReceiver receiver_;
  FrameMailbox& mailbox_;
  const std::size_t slot_;
  const std::vector<DatagramTap*> taps_;
  FrameTap* const frame_tap_;
  const std::string access_point_;
  FrameCensus census_;
  std::string failure_;  // why the source ended before its time
  StageProgress progress_;
  std::atomic<bool> stopping_ = false;
  mutable std::mutex mutex_;
  SourceReport report_;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace rayloc
