// Pipeline: from datagrams to locations; owns every thread between a source and a LocationSink, or
// shares them with other pipelines (PipelineOptions::threads).
//
//   sources (SourceWorker; own or shared threads) -> FrameMailbox
//     -> estimation (EstimationLoop; own or shared thread): BurstCollector -> BurstQueue ->
//     Estimator -> LocationSink
//
// raylocd and `rayloc replay` run this class; only the sources, the overflow rule and the sink
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
#include "daemon/pipeline/shared/worker_pool.h"
#include "daemon/pipeline/source_worker.h"

namespace rayloc {

class EstimationLoop;
struct Carried;
struct Estimates;
struct Location;
struct SharedThreads;
struct TrackEvent;
struct ZoneEvent;

// Computes locations from bursts. Called by one thread at a time, not always the same.
class Estimator {
 public:
  virtual ~Estimator() = default;
  // Appends the results to be published: none for a transmitter that is not to be located.
  virtual void estimate(const Burst& burst, Estimates& out) = 0;
  // [burst]: the same results as for one after the other, sooner where cores can share the bursts.
  // REQUIRES: every burst is of another transmitter.
  virtual void estimate_each(std::span<const Burst> bursts, std::span<Estimates> out);
  // Takes back bursts that were passed to it, once their results are published.
  virtual void release(std::vector<Burst>&& /*bursts*/) {}
  // No later burst has a frame before `time`, except of transmitters that wait: appends the results
  // that follow from silence.
  virtual void advance(Timestamp /*time*/, const IsWaiting& /*is_waiting*/, Estimates& /*out*/) {}
  // A recording continues at another position, perhaps earlier: every track ends with that
  // `reason`. Appends the resulting events.
  virtual void restart(const std::string& /*reason*/, Estimates& /*out*/) {}
  // Adds the state before carried.done that a successor cannot recover from the frames.
  virtual void carry(Carried& /*carried*/) const {}
  // Priority of the transmitter when there are more bursts than time.
  virtual Rank rank(const MacAddress& /*transmitter*/) const { return Rank::kOther; }
};

// Receives the results. Called by one thread at a time, not always the same, and must not block it
// for long: other sites wait for it.
class LocationSink {
 public:
  virtual ~LocationSink() = default;
  virtual void location(Location&& location) = 0;
  virtual void event(TrackEvent&& /*event*/) {}
  virtual void event(ZoneEvent&& /*event*/) {}
  // No later result refers to an instant before `time`, except the ends of tracks that no silence
  // causes: at a stop (Pipeline::end_tracks), and where a user moves a recording (Playback).
  virtual void advance(Timestamp /*time*/) {}
  // The state that a successor needs to report all results from carried.done on.
  virtual void carried(Carried&& /*carried*/) {}
};

// taken = used + surplus + unwanted + refused + merged + dropped + in_flight, in frames.
struct EstimationCounters {
  std::uint64_t taken = 0;
  std::uint64_t used = 0;     // in bursts that an estimator processed, NO_FIX included
  std::uint64_t surplus = 0;  // beyond the limit of frames per burst
  // Of transmitters that are not to be located, or of bursts that had ended before a warm start.
  std::uint64_t unwanted = 0;
  std::uint64_t refused = 0;  // beyond the limit of transmitters
  std::uint64_t merged = 0;   // in bursts replaced by a newer one of their transmitter
  std::uint64_t dropped = 0;  // in bursts that waited for others until they were too old
  std::uint64_t in_flight = 0;
  std::uint64_t bursts = 0;
  std::uint64_t bursts_merged = 0;
  std::uint64_t bursts_dropped = 0;
  std::uint64_t bursts_in_flight = 0;
  std::uint64_t snapshots = 0;
  std::uint64_t no_fix = 0;    // among them, those without a position
  std::uint64_t filtered = 0;  // estimates of trackers
  std::uint64_t events = 0;    // of tracks and zones
  // Live: the bursts that ended, by Rank; those that are being processed count as waiting.
  // Otherwise empty.
  std::vector<RankCounts> ranks;
};

struct PipelineOptions {
  CollectorOptions burst;
  std::size_t ring_frames = 8192;  // frames waiting per source
  // Applies when estimates take longer than the frame interval: live the oldest are dropped and
  // counted, frames in FrameMailbox and bursts in BurstQueue; a replay waits.
  Overflow overflow = Overflow::kDropOldest;
  // Bursts of different transmitters that the cores share, live: a larger number balances the cores
  // better, but the first burst waits for the last. A replay processes them one by one.
  std::size_t bursts_at_once = default_bursts_at_once();
  static std::size_t default_bursts_at_once();
  // To begin in the middle: the bursts that are open there, and the time from which results are
  // published. The estimators receive the rest (Carried).
  OpenBursts open;
  Timestamp from = Timestamp::min();
  // From one LocationSink::carried() to the next, in event time; zero: never.
  Duration carry_every{};
  // Promises of the sources are stored with their datagrams, so that a later reader gets the same
  // promises, and silence is determined up to them. Otherwise silence is determined up to the
  // newest frame, because recordings contain no promises.
  bool promises_are_kept = false;
  // Threads shared by the pipelines of a process: the results are the same. Null: it has a thread
  // for each source and one for the estimation.
  std::shared_ptr<SharedThreads> threads = {};
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

  // Every source has ended and all received frames have been processed.
  bool finished() const { return finished_; }

  // Ends the sources; received frames are still processed. Returns when all is done.
  void stop();
  // When all frames are processed every track and every stay ends with that reason: no successor
  // continues them. To be called before stop().
  void end_tracks(const std::string& reason);
  // The datagram sources of the lanes, in their order: a successor may continue with them, or use
  // their ports. REQUIRES: stop() has returned.
  std::vector<std::unique_ptr<DatagramSource>> release_sources();
  // Makes a stop() in another thread return soon: waiting bursts are not processed.
  void cancel_pending();
  // Waits for the sources to end by themselves (recordings).
  void wait();

  std::vector<SourceReport> source_reports() const;
  std::vector<MailboxCounters> mailbox_counters() const;
  EstimationCounters estimation_counters() const;
  // Every thread; the pipeline outlives the returned stages.
  std::vector<Stage> stages() const;

 private:
  void estimate_all();
  WorkerPool::Turn take_turn();
  void join();

  const std::shared_ptr<SharedThreads> threads_;  // may be null
  FrameMailbox mailbox_;
  std::unique_ptr<EstimationLoop> loop_;
  std::vector<std::unique_ptr<SourceWorker>> workers_;
  std::atomic<bool> finished_ = false;
  std::thread estimation_;
  std::unique_ptr<WorkerPool::Member> turns_;  // of the estimation in threads_; null: none
};

}  // namespace rayloc
