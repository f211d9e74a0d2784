// SourceLane: processes the datagrams of one access point, step by step and without a thread: it
// reads them, passes them to the recorder and the ring, decodes and assembles them, and puts the
// frames into the mailbox.
//
// Thread safety: one thread; report() from any.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
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

// Receives every datagram that a source delivers, before it is decoded.
class DatagramTap {
 public:
  virtual ~DatagramTap() = default;
  virtual void tap(std::span<const Datagram> datagrams) = 0;
  // No later datagram is older.
  virtual void advance(Timestamp /*watermark*/) {}
  // The following datagrams are from another position of a recording.
  virtual void moved() {}
};

// Receives every frame that was assembled from them, before it is processed.
class FrameTap {
 public:
  virtual ~FrameTap() = default;
  virtual void tap(const std::string& access_point, std::span<const CsiFrame> frames) = 0;
};

// Progress of a source; one consistent snapshot.
struct SourceReport {
  std::string access_point;
  std::string description;
  SourceCounters source;
  CsiReceiverCounters receiver;
  FrameCensus frames;
  std::string stamps;         // fault of its time stamps: StampTally::text()
  Timestamp last_datagram{};  // event time; the epoch when none came
  std::chrono::steady_clock::time_point last_arrival{};  // of it: monotonic clock
  bool ended = false;  // permanently, or until a playback seeks to another position
  // The reason why it ended early or, for a source that continues, why it cannot be read now; empty
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

  // Takes the datagrams that arrived or arrive within `timeout`. False when the source has ended.
  bool step(Duration timeout);
  // True if the last step received no datagrams.
  bool was_idle() const { return batch_.datagrams.empty(); }
  // Reading has ended: the remaining frames are put into the mailbox.
  void finish();
  // The datagram source, with its open port. REQUIRES: finish().
  std::unique_ptr<DatagramSource> release() { return std::move(source_); }

  SourceReport report() const;
  const StageProgress& progress() const { return progress_; }
  // Its thread serves other sources as well, so no step waits for room in the mailbox: has_room()
  // is to be asked before each. To be called before the first step.
  void share_thread() { mailbox_.never_wait(slot_); }
  bool has_room() const { return mailbox_.has_room(slot_); }
  // As DatagramSource::poll_descriptor().
  std::optional<int> poll_descriptor() const { return source_->poll_descriptor(); }

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
  std::vector<CsiFrame> frames_;  // frames of the current step
  FrameCensus census_;
  StampTally stamps_;
  std::string failure_;  // reason why the source ended early
  StageProgress progress_;
  mutable std::mutex mutex_;
  SourceReport report_;  // guarded by mutex_
};

}  // namespace rayloc
