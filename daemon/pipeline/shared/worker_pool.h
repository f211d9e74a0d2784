// WorkerPool: a bounded number of threads that work for any number of members, in turns. A member
// has at most one place in the queue and one turn at a time, so the work of one never fills the
// queue before that of others (fair_queue.h).
//
// A turn is not interrupted: a member waits for the rest of the turns that run, and for the members
// that have used less.
//
// Thread safety: any thread. A turn calls no function of the pool.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "daemon/pipeline/shared/fair_queue.h"

namespace rayloc {

class WorkerPool {
 public:
  enum class Turn : std::uint8_t {
    kMore,   // there is more work
    kWaits,  // there is none until wake()
    kEnded   // there will be none
  };

  class Member : private FairQueue::Share {
   public:
    // REQUIRES: it has ended.
    ~Member() = default;
    Member(const Member&) = delete;
    Member& operator=(const Member&) = delete;
    // There may be work again. A wake-up during a turn causes another turn.
    void wake() { pool_.wake(*this); }
    // Returns when a turn was the last one.
    void wait_for_end() { pool_.wait_for_end(*this); }

   private:
    friend class WorkerPool;
    enum class State : std::uint8_t { kIdle, kQueued, kRuns, kRunsAndWoken, kEnded };
    Member(WorkerPool& pool, std::function<Turn()> turn) : pool_(pool), turn_(std::move(turn)) {}

    WorkerPool& pool_;
    const std::function<Turn()> turn_;
    State state_ = State::kQueued;  // guarded by the mutex of the pool, as the share
  };

  // At most so many threads, and no more than members: each is started when a member is added.
  // `now`: a monotonic clock, which measures turns.
  explicit WorkerPool(std::size_t most_threads, std::function<Duration()> now = steady_time);
  // REQUIRES: every member has ended.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // `turn` is called soon, and never twice at the same time.
  std::unique_ptr<Member> add(std::function<Turn()> turn);

  std::size_t threads() const;
  static Duration steady_time();

 private:
  void wake(Member& member);
  void wait_for_end(Member& member);
  void run();
  void queue(Member& member);
  Member* next(std::unique_lock<std::mutex>& lock);
  void conclude(Member& member, Turn turn, Duration used);

  const std::size_t most_threads_;
  const std::function<Duration()> now_;
  mutable std::mutex mutex_;
  std::condition_variable queued_;    // a member was queued, or the pool ends
  std::condition_variable ended_;     // a member has ended
  FairQueue queue_;                   // guarded by mutex_
  std::size_t members_ = 0;           // guarded by mutex_: that have not ended
  bool is_ending_ = false;            // guarded by mutex_
  std::vector<std::thread> threads_;  // guarded by mutex_
};

}  // namespace rayloc
