// Pipeline: from datagrams to locations; owns every thread between a source and a LocationSink.
//
//   source threads (SourceWorker) -> FrameMailbox
//     -> estimation thread (EstimationLoop): BurstCollector -> BurstQueue -> Estimator ->
//     LocationSink
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
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "daemon/pipeline/burst_collector.h"
#include "daemon/pipeline/burst_queue.h"
#include "daemon/pipeline/frame_mailbox.h"
#include "daemon/pipeline/source_worker.h"

namespace rayloc {

class EstimationLoop;
struct Carried;
struct Estimates;
struct Location;
struct TrackEvent;
struct ZoneEvent;

// Explains bursts. Called by the estimation thread alone.
class Estimator {
 public:
  virtual ~Estimator() = default;
  // Appends what is to be published: nothing for a transmitter that nobody looks for.
  virtual void estimate(const Burst& burst, Estimates& out) = 0;
  // [burst]: the same as of one after the other, sooner where cores can share them. REQUIRES: every
  // burst is of another transmitter.
  virtual void estimate_each(std::span<const Burst> bursts, std::span<Estimates> out);
  // Bursts that it was given, once what it said of them is given out.
  virtual void release(std::vector<Burst>&& /*bursts*/) {}
  // No burst that comes later has a frame before `time`: appends what silence says.
  virtual void advance(Timestamp /*time*/, Estimates& /*out*/) {}
  // A recording goes on elsewhere, perhaps earlier: every track ends, for that `reason`. Appends
  // what says so.
  virtual void restart(const std::string& /*reason*/, Estimates& /*out*/) {}
  // States what a successor cannot hear again, of everything before carried.done: adds to it.
  virtual void carry(Carried& /*carried*/) const {}
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
  // What a successor needs who is to say all from carried.done on.
  virtual void carried(Carried&& /*carried*/) {}
};

// taken = used + surplus + unwanted + refused + merged + dropped + in_flight, in frames.
struct EstimationCounters {
  std::uint64_t taken = 0;
  std::uint64_t used = 0;     // in bursts that an estimator explained, NO_FIX included
  std::uint64_t surplus = 0;  // beyond what a burst keeps
  // Of transmitters that nobody looks for, or of bursts that were over before a warm start.
  std::uint64_t unwanted = 0;
  std::uint64_t refused = 0;  // beyond the limit of transmitters
  std::uint64_t merged = 0;   // in bursts that gave way to a newer one of their transmitter
  std::uint64_t dropped = 0;  // in bursts that others kept waiting until they were too old
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
  // Bursts of different transmitters that the cores share, live: more balance the cores better, and
  // the first waits for the last. A replay explains one after the other.
  std::size_t bursts_at_once = default_bursts_at_once();
  static std::size_t default_bursts_at_once();
  // To begin in the middle: the bursts that are open there, and from when on what is said is given
  // out. The estimators are told the rest (Carried).
  OpenBursts open;
  Timestamp from = Timestamp::min();
  // From one LocationSink::carried() to the next, in event time; zero: never.
  Duration carry_every{};
  // What the sources promise is kept with what they heard, so that whoever reads it again is
  // promised the same: silence is known as far. Else it is known up to the newest frame, for
  // recordings hold nothing more.
  bool promises_are_kept = false;
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
  // When everything is estimated every track and every stay ends, for that reason: nobody goes on
  // with them. Before stop().
  void end_tracks(const std::string& reason);
  // What the sources read from, in their order: who comes after may go on with it, or have its
  // ports. REQUIRES: stop() has returned.
  std::vector<std::unique_ptr<DatagramSource>> release_sources();
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
  void join();

  FrameMailbox mailbox_;
  std::unique_ptr<EstimationLoop> loop_;
  std::vector<std::unique_ptr<SourceWorker>> workers_;
  std::atomic<bool> finished_ = false;
  std::thread estimation_;
};

}  // namespace rayloc
