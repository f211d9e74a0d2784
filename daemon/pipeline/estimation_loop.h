// EstimationLoop: what the estimation thread of a Pipeline does, turn by turn: takes frames of the
// mailbox, collects bursts, explains them and gives out what is said. It has no thread.
//
// A warm start (PipelineOptions::from) is silent about what its predecessor has said. At marks of
// event time, PipelineOptions::carry_every apart, it states what its own successor needs. They lie
// between frames, so that what is stated depends on these alone.
//
// Thread safety: step() for one thread; the others from any.
#pragma once

#include <atomic>
#include <cstdint>
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

  // One turn: waits for frames where there is nothing to explain. False once all is done.
  bool step();
  // What waits is left unexplained from now on.
  void hurry() { hurried_ = true; }
  // Once all is done every track and every stay ends, for that reason: nobody goes on with them.
  void end_tracks(const std::string& reason);

  EstimationCounters counters() const;
  const StageProgress& progress() const { return progress_; }
  StageProgress& progress() { return progress_; }

 private:
  bool is_live() const { return options_.overflow == Overflow::kDropOldest; }
  bool has_frames() const { return next_ < taken_.frames.size(); }
  CollectorOptions collector_options() const;
  BurstQueueOptions queue_options() const;
  void take();
  void collect();
  bool reaches_mark(Timestamp time, bool is_frame);
  void note_silence();
  void say();
  void carry(Timestamp done);
  void count_collected(std::uint64_t passed_over);
  std::vector<Burst> next_of_waiting();
  void explain(std::vector<Burst> bursts);
  void count(const Burst& burst, const Estimates& estimates);
  void go_elsewhere();
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
  std::size_t uncounted_ = 0;  // of taken_.frames
  bool more_ = true;           // to take
  bool is_collected_ = true;   // all that was taken
  std::vector<Burst> ended_;
  Timestamp newest_ = Timestamp::min();     // frame
  Timestamp known_ = Timestamp::min();      // up to where silence is one
  Timestamp safe_time_ = Timestamp::min();  // of what was collected
  std::optional<Timestamp> mark_;           // the last
  bool is_carry_due_ = false;
  std::atomic<bool> hurried_ = false;
  mutable std::mutex mutex_;
  EstimationCounters counters_;  // guarded by mutex_
  std::string end_of_tracks_;    // guarded by mutex_; why; empty: they do not end
  StageProgress progress_;
};

}  // namespace rayloc
