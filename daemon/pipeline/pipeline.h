// Pipeline: from datagrams to locations; owns every thread between a source and a LocationSink.
//
//   source threads (SourceWorker) -> FrameMailbox
//     -> estimation thread: BurstCollector -> BurstQueue -> Estimator -> LocationSink
//
// raylocd and `rayloc replay` run this very class; only the sources, the overflow rule and the sink
// differ. Event time is that of the datagrams; no stage reads a clock, so that the same datagrams
// give the same locations at any speed.
//
// Conservation, per source: delivered datagrams = rejected + duplicates + late + in frames + in
// flight (CsiReceiverCounters); frames = dropped + taken + waiting (MailboxCounters); over all
// sources: taken = used + surplus + unwanted + refused + merged + dropped + in flight
// (EstimationCounters).
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "daemon/pipeline/burst_collector.h"
#include "daemon/pipeline/burst_queue.h"
#include "daemon/pipeline/frame_mailbox.h"
#include "daemon/pipeline/source_worker.h"

namespace rayloc {

struct Estimates;
struct Location;
struct TrackEvent;
struct ZoneEvent;

// Explains a burst. Called by the estimation thread alone.
class Estimator {
 public:
  virtual ~Estimator() = default;
  // Appends what is to be published: nothing for a transmitter that nobody looks for.
  virtual void estimate(const Burst& burst, Estimates& out) = 0;
  // No burst that comes later has a frame before `time`: appends what silence says.
  virtual void advance(Timestamp /*time*/, Estimates& /*out*/) {}
  // A recording goes on elsewhere, perhaps earlier: every track ends, for that `reason`. Appends
  // what says so.
  virtual void restart(const std::string& /*reason*/, Estimates& /*out*/) {}
  // Who comes first when there are more bursts than time.
  virtual Rank rank(const MacAddress& /*transmitter*/) const { return Rank::kOther; }
};

// Takes the results. Called by the estimation thread alone, and must not block it for long.
class LocationSink {
 public:
  virtual ~LocationSink() = default;
  virtual void location(Location&& location) = 0;
  virtual void event(TrackEvent&& /*event*/) {}
  virtual void event(ZoneEvent&& /*event*/) {}
  // No location that comes later refers to an instant before `time`, unless the sources are
  // recordings that people move (Playback).
  virtual void advance(Timestamp /*time*/) {}
};

// taken = used + surplus + unwanted + refused + merged + dropped + in_flight, in frames.
struct EstimationCounters {
  std::uint64_t taken = 0;
  std::uint64_t used = 0;      // in bursts that an estimator explained, NO_FIX included
  std::uint64_t surplus = 0;   // beyond what a burst keeps
  std::uint64_t unwanted = 0;  // of transmitters that nobody looks for
  std::uint64_t refused = 0;   // beyond the limit of transmitters
  std::uint64_t merged = 0;    // in bursts that gave way to a newer one of their transmitter
  std::uint64_t dropped = 0;   // in bursts that others kept waiting until they were too old
  std::uint64_t in_flight = 0;
  std::uint64_t bursts = 0;
  std::uint64_t bursts_merged = 0;
  std::uint64_t bursts_dropped = 0;
  std::uint64_t bursts_in_flight = 0;
  std::uint64_t snapshots = 0;
  std::uint64_t no_fix = 0;    // among them, those without a position
  std::uint64_t filtered = 0;  // estimates of trackers
  std::uint64_t events = 0;    // of tracks and zones
};

struct PipelineOptions {
  CollectorOptions burst;
  std::size_t ring_frames = 8192;  // frames waiting per source
  // When estimates take longer than the frames do to come: live the oldest gives way, of frames in
  // FrameMailbox and of bursts in BurstQueue, and is counted; a replay waits.
  Overflow overflow = Overflow::kDropOldest;
};

class Pipeline {
 public:
  // `estimator` and `sink` outlive the pipeline.
  Pipeline(const PipelineOptions& options,
           std::vector<SourceWorker::Input> sources,
           Estimator& estimator,
           LocationSink& sink);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  void start();

  // Every source has ended and everything that came has been estimated.
  bool finished() const { return finished_; }

  // Ends the sources; what has been received is still estimated. Returns when all is done.
  void stop();
  // Makes a stop() that another thread is in return soon: what waits is left unexplained.
  void hurry();
  // Waits for the sources to end by themselves (recordings).
  void wait();

  std::vector<SourceReport> source_reports() const;
  std::vector<MailboxCounters> mailbox_counters() const;
  EstimationCounters estimation_counters() const;
  // Every thread; the pipeline outlives what it returns.
  std::vector<Stage> stages() const;

 private:
  void estimate_all();
  CollectorOptions collector_options() const;
  BurstQueueOptions queue_options() const;
  void count(const BurstCollector& collector, const BurstQueue& waiting, std::size_t taken);
  void explain(const Burst& burst);
  void go_elsewhere(BurstQueue& waiting);
  void publish(Estimates& estimates);
  void join();

  const PipelineOptions options_;
  Estimator& estimator_;
  LocationSink& sink_;
  FrameMailbox mailbox_;
  std::vector<std::unique_ptr<SourceWorker>> workers_;
  std::atomic<bool> finished_ = false;
  std::atomic<bool> hurried_ = false;
  mutable std::mutex mutex_;
  EstimationCounters counters_;  // guarded by mutex_
  StageProgress progress_;       // of the estimation thread
  std::thread estimation_;
};

}  // namespace rayloc
