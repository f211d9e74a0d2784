// OutStage: writes the results of the owner of a site to the stream of results, and then passes
// them to the local subscribers: nothing is published here that the broker has not stored.
//
// Each record contains all results for instants before its `done` (out_items.h),
// as far as the broker takes it in one message, and the state from which a
// successor continues. So results and the input position change together, and no
// result is published twice or lost when another worker takes over.
//
// For a standby it publishes nothing: it compares the results computed here with the owner's
// records (standby_audit.h), until this worker is the owner and continues after the last of them.
//
// Thread safety: LocationSink from one thread, the rest from any.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "daemon/live/cluster/ownership/out_items.h"
#include "daemon/live/cluster/ownership/owner_log.h"
#include "daemon/live/cluster/ownership/standby_audit.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/stage_progress.h"
#include "daemon/pipeline/warm/carried.h"

namespace rayloc {

class OutStage final : public LocationSink {
 public:
  struct Options {
    Duration every = std::chrono::milliseconds(50);  // minimum interval between records
    // A record without results reports the progress of the input.
    Duration at_most = std::chrono::seconds(1);
    // Duration of input that a successor reads again.
    Duration warm_up = std::chrono::seconds(5);
    // Returns the place that precedes all data received at that time or later.
    std::function<SiteResume(Timestamp time)> resume;
    // Called with the end of the computed results, whatever the broker has stored.
    std::function<void(Timestamp done)> progress;
    // Limit of items that the broker does not take: beyond it the site is given up.
    std::size_t most_waiting = 100'000;
  };

  // `inner` receives the stored results, and outlives it.
  OutStage(std::unique_ptr<OwnerLog> log, LocationSink& inner, Options options);
  // Standby for the owner that `audit` names, started from `start`.
  OutStage(const SiteStart& start,
           LocationSink& inner,
           Options options,
           const StandbyAudit::Options& audit);
  ~OutStage() override;
  OutStage(const OutStage&) = delete;
  OutStage& operator=(const OutStage&) = delete;

  void location(Location&& location) override;
  void event(TrackEvent&& event) override;
  void event(ZoneEvent&& event) override;
  void advance(Timestamp time) override;
  void carried(Carried&& carried) override;

  // While it is a standby: takes a record of the owner. From any thread.
  void receive(v1::OutputRecord&& record);
  // State of a standby; nothing once it is promoted.
  struct Standby {
    StandbyAudit::Counters counters;
    std::string first_difference;
    std::string trouble;
  };
  std::optional<Standby> standby() const;
  // Results before this instant are removed, as published by the owner; for a standby.
  Timestamp gone_before() const;
  // This worker owns the site from now on. REQUIRES: a standby, without a trouble.
  void promote(std::unique_ptr<OwnerLog> log);

  void start();
  // Takes no more results. Publishes what is ready, gives the site back, and ends the thread.
  void finish();

  // Reason why it no longer publishes; empty while it does.
  std::string ended() const;
  struct Counters {
    std::uint64_t records = 0;
    std::uint64_t items = 0;
    std::uint64_t waiting = 0;   // items
    std::uint64_t left_out = 0;  // items of instants too large for the broker
  };
  Counters counters() const;
  // Results left out since the last call.
  std::vector<std::string> notices();
  const StageProgress& progress() const { return progress_; }

 private:
  using Item = OutItems::Item;
  using Time = std::chrono::steady_clock::time_point;

  void hold(Item&& item);
  void run();
  bool wait_for_something();
  OutItems::Part next_part();
  void add_successor(Timestamp done, v1::SiteOutput& output);
  void compare();
  std::string trouble() const;
  void forget_before(Timestamp open);
  bool append(const v1::SiteOutput& output);
  void pass_on(OutItems::Part&& part);
  void give_up_where_too_much_waits();
  void end(const std::string& why);

  std::unique_ptr<OwnerLog> log_;  // null while it is a standby
  LocationSink& inner_;
  const Options options_;
  StageProgress progress_;
  Time written_{};  // used by the thread alone; time of the last stored record
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  OutItems items_;                       // guarded by mutex_
  std::deque<Carried> records_;          // guarded by mutex_; for the successor
  std::size_t prune_at_ = 32;            // guarded by mutex_; a count of records_
  std::string ended_;                    // guarded by mutex_
  std::unique_ptr<StandbyAudit> audit_;  // guarded by mutex_; null: it is not a standby
  bool closed_ = false;                  // guarded by mutex_: takes no more results
  bool finishing_ = false;               // guarded by mutex_
  Time finish_until_{};                  // guarded by mutex_; then unwritten results are dropped
  Counters counters_;                    // guarded by mutex_
  std::uint64_t reported_ = 0;           // guarded by mutex_: reported part of left_out
  std::thread thread_;
};

// Passes on frames from `from` on: the previous owner has published earlier ones.
class LaterFrames final : public FrameTap {
 public:
  LaterFrames(FrameTap& inner, Timestamp from) : inner_(inner), from_(from) {}
  void tap(const std::string& access_point, std::span<const CsiFrame> frames) override;
  // A standby passes on nothing until it is the owner.
  void set_from(Timestamp from) { from_ = from; }

 private:
  FrameTap& inner_;
  std::atomic<Timestamp> from_;
};

}  // namespace rayloc
