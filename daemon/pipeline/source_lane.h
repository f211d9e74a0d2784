// SourceLane: what becomes of the datagrams of one access point, step by step and without a thread:
// it reads them, shows them to the recorder and the ring, decodes and assembles them, and leaves
// the frames in the mailbox.
//
// Thread safety: one thread; report() from any.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "capture/assemble/csi_receiver.h"
#include "capture/transport/datagram_source.h"
#include "daemon/pipeline/frame_census.h"
#include "daemon/pipeline/frame_mailbox.h"
#include "daemon/pipeline/stage_progress.h"
#include "daemon/pipeline/watch/stamp_check.h"

namespace rayloc {

// Sees every datagram that a source delivers, before it is decoded.
class DatagramTap {
 public:
  virtual ~DatagramTap() = default;
  virtual void tap(std::span<const Datagram> datagrams) = 0;
  // No datagram that comes later is older.
  virtual void advance(Timestamp /*watermark*/) {}
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
  std::string stamps;         // what is wrong with its time stamps: StampTally::text()
  Timestamp last_datagram{};  // event time; the epoch when none came
  std::chrono::steady_clock::time_point last_arrival{};  // of it: nobody can set this clock
  bool ended = false;  // for good, or until a recording that is played goes on elsewhere
  // Why it ended before its time, or, of a source that goes on, why nothing can be read now; empty
  // otherwise.
  std::string error;
};

struct SourceInput {
  std::string access_point;  // id
  std::unique_ptr<DatagramSource> source;
  CsiReceiverOptions receiver;
  std::vector<DatagramTap*> taps;  // outlive the lane
  FrameTap* frame_tap = nullptr;   // may be null; outlives the lane
};

class SourceLane {
 public:
  // `slot`: the source's number in `mailbox`, which outlives the lane.
  SourceLane(SourceInput input, FrameMailbox& mailbox, std::size_t slot);

  // Takes what has come, or comes within `timeout`. False when the source has ended.
  bool step(Duration timeout);
  // Whether the last step found nothing.
  bool was_idle() const { return batch_.datagrams.empty(); }
  // Nothing is read any more: what is left of frames goes to the mailbox.
  void finish();
  // What it read from, with the port that it holds. REQUIRES: finish().
  std::unique_ptr<DatagramSource> release() { return std::move(source_); }

  SourceReport report() const;
  const StageProgress& progress() const { return progress_; }

 private:
  void move(std::uint64_t number);
  void show();
  void publish_report();

  std::unique_ptr<DatagramSource> source_;  // null once it is released
  CsiReceiver receiver_;
  FrameMailbox& mailbox_;
  const std::size_t slot_;
  const std::vector<DatagramTap*> taps_;
  FrameTap* const frame_tap_;
  const std::string access_point_;
  DatagramBatch batch_;
  std::vector<CsiFrame> frames_;  // of the step
  FrameCensus census_;
  StampTally stamps_;
  std::string failure_;  // why the source ended before its time
  StageProgress progress_;
  mutable std::mutex mutex_;
  SourceReport report_;  // guarded by mutex_
};

}  // namespace rayloc
