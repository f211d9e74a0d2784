// ComparedMethod: a method that locates the same bursts as the site's method, so that both can be
// compared side by side (COMPARED.md).
//
// It works on its own thread, at the lowest priority and without the help of other threads. Its
// waiting bursts are bounded as in a BurstQueue: a newer burst of a transmitter replaces the older,
// which is counted. The estimation thread waits for it no longer than Options::patience: if the
// queue is locked for longer, which a thread of lowest priority may cause, the burst is dropped and
// counted, too. restart(), a seek in a recording, waits for the lock.
//
// Thread safety: add(), advance() and restart() for the estimation thread; start() and stop() for
// one other; counters() from any.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "daemon/pipeline/burst_queue.h"
#include "daemon/pipeline/estimator_list.h"
#include "daemon/pipeline/pipeline.h"

namespace rayloc {

// bursts = explained + dropped + in_flight, for the bursts that it wants.
struct ComparedMethodCounters {
  std::uint64_t bursts = 0;
  std::uint64_t explained = 0;
  std::uint64_t dropped = 0;
  std::uint64_t in_flight = 0;
  std::uint64_t fixes = 0;  // snapshots with a position
  std::uint64_t no_fixes = 0;
  std::uint64_t filtered = 0;   // estimates of trackers
  std::uint64_t coalesced = 0;  // estimates that were replaced by newer ones before they were sent
};

class ComparedMethod {
 public:
  struct Options {
    std::string name;
    std::size_t max_frames = 8192;  // of the waiting bursts
    std::chrono::steady_clock::duration patience = std::chrono::milliseconds(1);
    // Transmitters whose bursts it processes, and their priority when there is too little time.
    std::function<bool(const MacAddress& transmitter)> wants = [](const MacAddress&) {
      return true;
    };
    RankOf rank = [](const MacAddress&) { return Rank::kOther; };
  };
  // Takes a result; true: it replaced an older estimate.
  using Sink = std::function<bool(Location&& location)>;

  ComparedMethod(Options options, std::vector<std::unique_ptr<Estimator>> estimators);
  ~ComparedMethod() { stop(); }
  ComparedMethod(const ComparedMethod&) = delete;
  ComparedMethod& operator=(const ComparedMethod&) = delete;

  const std::string& name() const { return options_.name; }
  void start(Sink sink);
  // Returns when the current burst is processed; waiting bursts are dropped.
  void stop();

  bool wants(const MacAddress& transmitter) const { return options_.wants(transmitter); }
  // REQUIRES: it wants the burst.
  void add(Burst&& burst);
  // No burst that is added later has a frame before `time`.
  void advance(Timestamp time);
  void restart(const std::string& reason);

  ComparedMethodCounters counters() const;

 private:
  std::unique_lock<std::mutex> lock_soon();
  void run();
  bool has_work() const;
  void work(std::unique_lock<std::mutex>& lock);
  void publish(Estimates& estimates);
  void drop_waiting();
  void count_displaced();

  const Options options_;
  const std::vector<std::unique_ptr<Estimator>> owned_;
  EstimatorList estimators_;  // used by its own thread
  Sink sink_;
  std::mutex mutex_;
  std::condition_variable wake_;
  BurstQueue waiting_;                     // guarded by mutex_
  Timestamp newest_ = Timestamp::min();    // guarded by mutex_; of bursts that were added
  Timestamp open_ = Timestamp::min();      // guarded by mutex_; as of advance()
  Timestamp advanced_ = Timestamp::min();  // guarded by mutex_; as passed to the estimators
  std::string restart_;                    // guarded by mutex_; reason of a pending restart
  bool stopping_ = false;                  // guarded by mutex_
  std::atomic<std::uint64_t> added_{0};
  std::atomic<std::uint64_t> explained_{0};
  std::atomic<std::uint64_t> not_taken_{0};  // dropped before the queue
  std::atomic<std::uint64_t> displaced_{0};  // dropped by the queue
  std::atomic<std::uint64_t> fixes_{0};
  std::atomic<std::uint64_t> no_fixes_{0};
  std::atomic<std::uint64_t> filtered_{0};
  std::atomic<std::uint64_t> coalesced_{0};
  std::thread thread_;
};

}  // namespace rayloc
