// EstimationLoop: the estimation of a Pipeline, in iterations: takes frames from the mailbox,
// collects and processes bursts, and passes the results on. It has no thread.
//
// After a warm start (PipelineOptions::from) it does not repeat the predecessor's results. At marks
// of event time, PipelineOptions::carry_every apart, it states the state that its own successor
// needs. Marks lie between frames, so that the state depends on the frames alone.
//
// Thread safety: step() from one thread at a time; the others from any.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "daemon/pipeline/pipeline.h"

namespace rayloc {

class EstimationLoop {
 public:
  // All of them outlive the loop.
  EstimationLoop(const PipelineOptions& options,
                 Estimator& estimator,
                 LocationSink& sink,
                 FrameMailbox& mailbox);

  enum class Step : std::uint8_t {
    kMore,   // another iteration may follow at once
    kWaits,  // no frames are there; only without `may_wait`
    kDone    // all is done
  };
  // One iteration. `may_wait`: for frames, if no burst is waiting.
  Step step(bool may_wait);
  // From now on waiting bursts are not processed.
  void cancel_pending() { is_cancelled_ = true; }
  // When all bursts are processed every track and every stay ends with that reason: none continues.
  void end_tracks(const std::string& reason);

  EstimationCounters counters() const;
  const StageProgress& progress() const { return progress_; }
  StageProgress& progress() { return progress_; }

 private:
  bool is_live() const { return options_.overflow == Overflow::kDropOldest; }
  bool has_frames() const { return next_ < taken_.frames.size(); }
  CollectorOptions collector_options() const;
  BurstQueueOptions queue_options() const;
  bool take(bool may_wait);
  void collect();
  bool reaches_mark(Timestamp time, bool is_frame);
  void note_silence();
  void note_waiting();
  Timestamp promise(Timestamp open);
  void advance_output();
  void carry(Timestamp done);
  void count_collected(std::uint64_t passed_over);
  std::vector<Burst> next_of_waiting();
  void explain(std::vector<Burst> bursts);
  void count(const Burst& burst, const Estimates& estimates);
  void count_ranks();
  void reset_after_seek();
  void finish();
  void restart_estimator(const std::string& reason);
  void publish(Estimates& estimates);

  const PipelineOptions options_;
  Estimator& estimator_;
  LocationSink& sink_;
  FrameMailbox& mailbox_;
  BurstCollector collector_;
  BurstQueue waiting_;
  FrameMailbox::Taken taken_;  // frames from next_ on are still to be collected
  std::size_t next_ = 0;
  std::size_t uncounted_ = 0;  // uncounted frames of taken_.frames
  bool more_ = true;           // frames may follow
  bool is_collected_ = true;   // all frames taken so far
  std::vector<Burst> ended_;
  Timestamp newest_ = Timestamp::min();     // newest frame
  Timestamp known_ = Timestamp::min();      // silence is reported up to this time
  Timestamp safe_time_ = Timestamp::min();  // of the collected frames
  Timestamp advanced_ = Timestamp::min();   // the estimator has reported silence up to this time
  // The same for each transmitter whose bursts wait: its silence before them is reported when the
  // next of them is processed, or none waits any more.
  std::map<MacAddress, Timestamp> reported_;
  std::optional<Timestamp> mark_;  // last mark
  bool is_carry_due_ = false;
  std::atomic<bool> is_cancelled_ = false;
  mutable std::mutex mutex_;
  EstimationCounters counters_;  // guarded by mutex_
  std::string end_of_tracks_;    // guarded by mutex_; reason; empty: tracks do not end
  StageProgress progress_;
};

}  // namespace rayloc
