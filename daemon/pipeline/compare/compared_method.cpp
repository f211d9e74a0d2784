#include "daemon/pipeline/compare/compared_method.h"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <utility>

#include "daemon/pipeline/estimates.h"
#include "engine/base/parallel.h"

namespace rayloc {
namespace {

constexpr Duration kSilenceStep = std::chrono::milliseconds(100);  // of event time
constexpr std::size_t kThreadName = 15;                            // pthread_setname_np(3)

// If the scheduling policy is refused the thread keeps its priority.
void yield_to_others() {
  const sched_param none{};
  (void)pthread_setschedparam(pthread_self(), SCHED_IDLE, &none);
}

BurstQueueOptions queue_options(const ComparedMethod::Options& options) {
  BurstQueueOptions queue;
  queue.max_frames = options.max_frames;
  queue.rank = options.rank;
  return queue;
}

}  // namespace

ComparedMethod::ComparedMethod(Options options, std::vector<std::unique_ptr<Estimator>> estimators)
    : options_(std::move(options)),
      owned_(std::move(estimators)),
      waiting_(queue_options(options_)) {
  for (const auto& estimator : owned_) {
    estimators_.add(*estimator);
  }
}

void ComparedMethod::start(Sink sink) {
  sink_ = std::move(sink);
  thread_ = std::thread([this] { run(); });
}

void ComparedMethod::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    drop_waiting();
  }
  wake_.notify_one();
  if (thread_.joinable()) {
    thread_.join();
  }
}

// Returns an unlocked lock if it could not be acquired in time.
std::unique_lock<std::mutex> ComparedMethod::lock_soon() {
  const auto deadline = std::chrono::steady_clock::now() + options_.patience;
  std::unique_lock lock(mutex_, std::try_to_lock);
  while (!lock.owns_lock() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield();
    (void)lock.try_lock();
  }
  return lock;
}

void ComparedMethod::add(Burst&& burst) {
  added_.fetch_add(1);
  {
    const auto lock = lock_soon();
    if (!lock.owns_lock() || stopping_) {
      not_taken_.fetch_add(1);
      return;
    }
    newest_ = std::max(newest_, burst.last);
    std::vector<Burst> one;
    one.push_back(std::move(burst));
    waiting_.push(one, newest_);
    count_displaced();
  }
  wake_.notify_one();
}

void ComparedMethod::advance(Timestamp time) {
  {
    const auto lock = lock_soon();
    if (!lock.owns_lock()) {
      return;  // the next call covers this time as well
    }
    open_ = std::max(open_, time);
    if (!has_work()) {
      return;
    }
  }
  wake_.notify_one();
}

void ComparedMethod::restart(const std::string& reason) {
  {
    const std::lock_guard lock(mutex_);
    drop_waiting();
    newest_ = open_ = advanced_ = Timestamp::min();
    restart_ = reason;
  }
  wake_.notify_one();
}

// REQUIRES: mutex_ is held; the same for count_displaced().
void ComparedMethod::drop_waiting() {
  waiting_.clear();
  count_displaced();
}

void ComparedMethod::count_displaced() {
  displaced_.store(waiting_.merged_bursts() + waiting_.dropped_bursts());
}

// Silence is processed when no burst waits: only then are all bursts still to come after `open_`.
bool ComparedMethod::has_work() const {
  return !restart_.empty() || !waiting_.empty() || open_ >= advanced_ + kSilenceStep;
}

void ComparedMethod::run() {
  pthread_setname_np(pthread_self(), ("cmp " + options_.name).substr(0, kThreadName).c_str());
  yield_to_others();
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    if (has_work()) {
      work(lock);
    } else {
      wake_.wait(lock);
    }
  }
}

// `lock` is released while an estimator works.
void ComparedMethod::work(std::unique_lock<std::mutex>& lock) {
  Estimates estimates;
  if (const std::string reason = std::exchange(restart_, {}); !reason.empty()) {
    lock.unlock();
    estimators_.restart(reason, estimates);
  } else if (!waiting_.empty()) {
    const Burst burst = waiting_.pop();
    lock.unlock();
    serially([&] { estimators_.estimate(burst, estimates); });
    explained_.fetch_add(1);
  } else {
    const Timestamp time = advanced_ = open_;
    lock.unlock();
    const auto none_waits = [](const MacAddress&) { return false; };
    serially([&] { estimators_.advance(time, none_waits, estimates); });
  }
  publish(estimates);
  lock.lock();
}

// Track events are published by the site's own method only.
void ComparedMethod::publish(Estimates& estimates) {
  for (Location& location : estimates.locations) {
    (location.is_filtered()       ? filtered_
     : location.estimate.position ? fixes_
                                  : no_fixes_)
        .fetch_add(1);
    if (sink_(std::move(location))) {
      coalesced_.fetch_add(1);
    }
  }
}

// In flight are the remaining bursts, so that the law holds at every instant.
ComparedMethodCounters ComparedMethod::counters() const {
  ComparedMethodCounters counters;
  counters.explained = explained_.load();
  counters.dropped = not_taken_.load() + displaced_.load();
  counters.bursts = added_.load();
  counters.in_flight = counters.bursts - counters.explained - counters.dropped;
  counters.fixes = fixes_.load();
  counters.no_fixes = no_fixes_.load();
  counters.filtered = filtered_.load();
  counters.coalesced = coalesced_.load();
  return counters;
}

}  // namespace rayloc
