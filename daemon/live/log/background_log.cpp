#include "daemon/live/log/background_log.h"

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <utility>

namespace rayloc {

struct BackgroundLog::Shared {
  Shared(Write write_entry, std::size_t limit)
      : write(std::move(write_entry)), max_waiting(limit) {}

  const Write write;
  const std::size_t max_waiting;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<LogEntry> waiting;  // guarded by mutex
  std::uint64_t put = 0;         // guarded by mutex
  std::uint64_t dropped = 0;     // guarded by mutex
  std::uint64_t written = 0;     // guarded by mutex
  bool ending = false;           // guarded by mutex
};

BackgroundLog::BackgroundLog(Write write,
                             std::size_t max_waiting,
                             std::chrono::milliseconds patience)
    : patience_(patience),
      shared_(std::make_shared<Shared>(std::move(write), max_waiting)),
      thread_([shared = shared_] { run(shared); }) {}

BackgroundLog::~BackgroundLog() {
  const bool written = flush();
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->ending = true;
  }
  shared_->changed.notify_all();
  if (written) {
    thread_.join();
  } else {
    thread_.detach();
  }
}

void BackgroundLog::put(LogEntry entry) {
  {
    const std::lock_guard lock(shared_->mutex);
    if (shared_->waiting.size() >= shared_->max_waiting) {
      shared_->waiting.pop_front();
      ++shared_->dropped;
    }
    shared_->waiting.push_back(std::move(entry));
    ++shared_->put;
  }
  shared_->changed.notify_all();
}

bool BackgroundLog::flush() const {
  std::unique_lock lock(shared_->mutex);
  const std::uint64_t all = shared_->put;
  return shared_->changed.wait_for(
      lock, patience_, [&] { return shared_->written + shared_->dropped >= all; });
}

std::uint64_t BackgroundLog::dropped() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->dropped;
}

void BackgroundLog::run(const std::shared_ptr<Shared>& shared) {
  std::unique_lock lock(shared->mutex);
  while (true) {
    shared->changed.wait(lock, [&] { return shared->ending || !shared->waiting.empty(); });
    if (shared->waiting.empty()) {
      return;
    }
    const LogEntry entry = std::move(shared->waiting.front());
    shared->waiting.pop_front();
    lock.unlock();
    try {
      shared->write(entry);
    } catch (const std::exception&) {  // no output is left to report it
    }
    lock.lock();
    ++shared->written;
    shared->changed.notify_all();
  }
}

}  // namespace rayloc
