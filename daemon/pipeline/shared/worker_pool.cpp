#include "daemon/pipeline/shared/worker_pool.h"

#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace rayloc {

Duration WorkerPool::steady_time() {
  return std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch());
}

WorkerPool::WorkerPool(std::size_t most_threads, std::function<Duration()> now)
    : most_threads_(std::max<std::size_t>(1, most_threads)), now_(std::move(now)) {}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  queued_.notify_all();
  for (std::thread& thread : threads_) {  // none is added any more
    thread.join();
  }
}

std::unique_ptr<WorkerPool::Member> WorkerPool::add(std::function<Turn()> turn) {
  std::unique_ptr<Member> member(new Member(*this, std::move(turn)));
  const std::lock_guard lock(mutex_);
  ++members_;
  if (threads_.size() < std::min(members_, most_threads_)) {
    threads_.emplace_back([this] { run(); });
  }
  queue(*member);
  return member;
}

std::size_t WorkerPool::threads() const {
  const std::lock_guard lock(mutex_);
  return threads_.size();
}

// REQUIRES: the mutex is held.
void WorkerPool::queue(Member& member) {
  member.state_ = Member::State::kQueued;
  queue_.push(member);
  queued_.notify_one();
}

void WorkerPool::wake(Member& member) {
  const std::lock_guard lock(mutex_);
  if (member.state_ == Member::State::kIdle) {
    queue(member);
  } else if (member.state_ == Member::State::kRuns) {
    member.state_ = Member::State::kRunsAndWoken;
  }
}

void WorkerPool::wait_for_end(Member& member) {
  std::unique_lock lock(mutex_);
  ended_.wait(lock, [&] { return member.state_ == Member::State::kEnded; });
}

void WorkerPool::run() {
  pthread_setname_np(pthread_self(), "estimation");  // for top -H
  std::unique_lock lock(mutex_);
  while (Member* const member = next(lock)) {
    lock.unlock();
    const Duration begin = now_();
    const Turn turn = member->turn_();
    const Duration used = now_() - begin;
    lock.lock();
    conclude(*member, turn, used);
  }
}

// Null when the pool ends.
WorkerPool::Member* WorkerPool::next(std::unique_lock<std::mutex>& lock) {
  queued_.wait(lock, [this] { return is_ending_ || !queue_.empty(); });
  if (is_ending_) {
    return nullptr;
  }
  auto* const member = static_cast<Member*>(queue_.pop());
  member->state_ = Member::State::kRuns;
  return member;
}

// REQUIRES: the mutex is held. The member may be destroyed after its end.
void WorkerPool::conclude(Member& member, Turn turn, Duration used) {
  member.used += used;
  if (turn == Turn::kEnded) {
    member.state_ = Member::State::kEnded;
    --members_;
    ended_.notify_all();
  } else if (turn == Turn::kMore || member.state_ == Member::State::kRunsAndWoken) {
    queue(member);
  } else {
    member.state_ = Member::State::kIdle;
  }
}

}  // namespace rayloc
