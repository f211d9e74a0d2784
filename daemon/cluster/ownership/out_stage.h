// OutStage: what the owner of a site finds, into the stream of results, and from there to whoever
// listens on this machine: nothing is said here that the broker has not taken.
//
// Each record holds all that refers to instants before its `done` (out_items.h), as far as the
// broker takes it in one message, and where and how a successor goes on. So results and the place
// of the input change together, and nothing is said twice or left out when another worker takes
// over.
//
// Of a worker that stands by it says nothing: it compares what is found here with what the owner
// says (standby_audit.h), until this worker is the owner, and then goes on behind its last word.
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

#include "daemon/cluster/ownership/out_items.h"
#include "daemon/cluster/ownership/owner_log.h"
#include "daemon/cluster/ownership/standby_audit.h"
#include "daemon/pipeline/pipeline.h"
#include "daemon/pipeline/stage_progress.h"
#include "daemon/pipeline/warm/carried.h"

namespace rayloc {

class OutStage final : public LocationSink {
 public:
  struct Options {
    Duration every = std::chrono::milliseconds(50);  // between records, at least
    // A record without results says how far the input was taken.
    Duration at_most = std::chrono::seconds(1);
    // What a successor listens to again.
    Duration warm_up = std::chrono::seconds(5);
    // From where it reads what was heard at that time or later.
    std::function<SiteResume(Timestamp time)> resume;
    // Told up to where all is found, whatever the broker has taken.
    std::function<void(Timestamp done)> progress;
    // More items than that, which the broker does not take: the site is given up.
    std::size_t most_waiting = 100'000;
  };

  // `inner` is told what was stored, and outlives it.
  OutStage(std::unique_ptr<OwnerLog> log, LocationSink& inner, Options options);
  // Stands by for the owner that `audit` names, and has begun as `start` says.
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

  // While it stands by: a word of the owner. From any thread.
  void hear(v1::OutputRecord&& record);
  // Of who stands by; nothing once it is promoted.
  struct Standby {
    StandbyAudit::Counters counters;
    std::string first_difference;
    std::string trouble;
  };
  std::optional<Standby> standby() const;
  // What is of an instant before is gone, as the owner had said it; of who stands by.
  Timestamp gone_before() const;
  // It is the owner's from now on. REQUIRES: it stands by, without a trouble.
  void promote(std::unique_ptr<OwnerLog> log);

  void start();
  // Nothing more is taken. Says what is ready, gives the site back, and ends the thread.
  void finish();

  // Why it says nothing any more; empty while it does.
  std::string ended() const;
  struct Counters {
    std::uint64_t records = 0;
    std::uint64_t items = 0;
    std::uint64_t waiting = 0;   // items
    std::uint64_t left_out = 0;  // items of instants that were too many for the broker
  };
  Counters counters() const;
  // What was left out since the last call.
  std::vector<std::string> news();
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
  bool say(const v1::SiteOutput& output);
  void pass_on(OutItems::Part&& part);
  void give_up_where_too_much_waits();
  void end(const std::string& why);

  std::unique_ptr<OwnerLog> log_;  // null while it stands by
  LocationSink& inner_;
  const Options options_;
  StageProgress progress_;
  Time said_{};  // used by the thread alone; when the last record was stored
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  OutItems items_;                       // guarded by mutex_
  std::deque<Carried> records_;          // guarded by mutex_; for the successor
  std::size_t prune_at_ = 32;            // guarded by mutex_; a count of records_
  std::string ended_;                    // guarded by mutex_
  std::unique_ptr<StandbyAudit> audit_;  // guarded by mutex_; null: it does not stand by
  bool closed_ = false;                  // guarded by mutex_: takes nothing more
  bool finishing_ = false;               // guarded by mutex_
  Time finish_until_{};                  // guarded by mutex_; then what is left is not said
  Counters counters_;                    // guarded by mutex_
  std::uint64_t told_ = 0;               // guarded by mutex_: of those left out
  std::thread thread_;
};

// Passes frames on that are not older: those before were said by the owner before this one.
class LaterFrames final : public FrameTap {
 public:
  LaterFrames(FrameTap& inner, Timestamp from) : inner_(inner), from_(from) {}
  void tap(const std::string& access_point, std::span<const CsiFrame> frames) override;
  // Who stands by passes on nothing until it is the owner.
  void set_from(Timestamp from) { from_ = from; }

 private:
  FrameTap& inner_;
  std::atomic<Timestamp> from_;
};

}  // namespace rayloc
