#include "daemon/pipeline/shared/receiver_pool.h"

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <thread>

#include "capture/transport/file_descriptor.h"

namespace rayloc {
namespace {

using SteadyClock = std::chrono::steady_clock;

}  // namespace

class ReceiverPool::Receiver {
 public:
  explicit Receiver(const Options& options)
      : options_(options),
        wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
        thread_([this] { run(); }) {}
  ~Receiver() {
    {
      const std::lock_guard lock(mutex_);
      is_ending_ = true;
    }
    wake();
    thread_.join();
  }
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  void add(PolledReader& reader) {
    const std::lock_guard lock(mutex_);  // no round has the reader before its wake-up
    readers_.push_back(&reader);
    wake();
  }
  std::size_t readers() const {
    const std::lock_guard lock(mutex_);
    return readers_.size();
  }
  bool has(const PolledReader& reader) const {
    const std::lock_guard lock(mutex_);
    return find(reader) != readers_.end();
  }
  void wait_for_end(const PolledReader& reader) {
    wake();
    std::unique_lock lock(mutex_);
    removed_.wait(lock, [&] { return find(reader) == readers_.end(); });
  }

 private:
  std::vector<PolledReader*>::const_iterator find(const PolledReader& reader) const {
    return std::find(readers_.begin(), readers_.end(), &reader);
  }
  void wake() const { (void)::eventfd_write(wake_.get(), 1); }
  void run();
  bool begin_round();
  bool wait_for_input();
  void take_steps(bool is_tick);

  const Options options_;
  const FileDescriptor wake_;
  mutable std::mutex mutex_;
  std::condition_variable removed_;
  std::vector<PolledReader*> readers_;  // guarded by mutex_
  bool is_ending_ = false;              // guarded by mutex_
  // Of the thread: the readers of this round, and their descriptors behind that of wake_.
  std::vector<PolledReader*> round_;
  std::vector<pollfd> descriptors_;
  SteadyClock::time_point next_tick_{};  // a new reader is read at once
  std::thread thread_;
};

void ReceiverPool::Receiver::run() {
  pthread_setname_np(pthread_self(), options_.name);  // for top -H
  while (begin_round()) {
    take_steps(wait_for_input());
  }
}

// False when the thread is to end.
bool ReceiverPool::Receiver::begin_round() {
  {
    const std::lock_guard lock(mutex_);
    if (is_ending_) {
      return false;
    }
    round_ = readers_;
  }
  descriptors_.assign(1, {.fd = wake_.get(), .events = POLLIN, .revents = 0});
  for (const PolledReader* const reader : round_) {
    descriptors_.push_back({.fd = reader->descriptor(), .events = POLLIN, .revents = 0});
  }
  return true;
}

// True if every reader is due.
bool ReceiverPool::Receiver::wait_for_input() {
  using std::chrono::milliseconds;
  // Without readers: until one is added. If there was no descriptor for wake_, the next tick
  // notices what has changed; poll() ignores the entry of -1.
  milliseconds wait = wake_.get() >= 0 ? milliseconds(-1) : options_.tick;
  if (!round_.empty()) {
    const bool has_more = std::any_of(round_.begin(), round_.end(), [](const PolledReader* reader) {
      return reader->may_have_more();
    });
    const auto rest = std::chrono::ceil<milliseconds>(next_tick_ - SteadyClock::now());
    wait = has_more ? milliseconds(0) : std::clamp(rest, milliseconds(0), options_.tick);
  }
  if (::poll(descriptors_.data(), descriptors_.size(), static_cast<int>(wait.count())) > 0 &&
      descriptors_.front().revents != 0) {
    eventfd_t ignored = 0;
    (void)::eventfd_read(wake_.get(), &ignored);
    next_tick_ = {};  // of the next round, which has the readers that were added
    return false;
  }
  const auto now = SteadyClock::now();
  if (now < next_tick_) {
    return false;
  }
  next_tick_ = now + options_.tick;
  return true;
}

void ReceiverPool::Receiver::take_steps(bool is_tick) {
  for (std::size_t i = 0; i < round_.size(); ++i) {
    PolledReader* const reader = round_[i];
    if (!is_tick && descriptors_[i + 1].revents == 0 && !reader->may_have_more()) {
      continue;
    }
    if (!reader->read_once()) {
      const std::lock_guard lock(mutex_);
      readers_.erase(find(*reader));
      removed_.notify_all();
    }
  }
}

ReceiverPool::ReceiverPool(const Options& options) : options_(options) {}

ReceiverPool::~ReceiverPool() = default;

void ReceiverPool::add(PolledReader& reader) {
  const std::lock_guard lock(mutex_);
  auto least = std::min_element(
      receivers_.begin(), receivers_.end(), [](const auto& one, const auto& other) {
        return one->readers() < other->readers();
      });
  const bool is_needed = least == receivers_.end() || (*least)->readers() > 0;
  if (is_needed && receivers_.size() < std::max<std::size_t>(1, options_.most_threads)) {
    receivers_.push_back(std::make_unique<Receiver>(options_));
    least = std::prev(receivers_.end());
  }
  (*least)->add(reader);
}

void ReceiverPool::wait_for_end(PolledReader& reader) {
  Receiver* its = nullptr;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& receiver : receivers_) {
      its = receiver->has(reader) ? receiver.get() : its;
    }
  }
  if (its != nullptr) {
    its->wait_for_end(reader);
  }
}

std::size_t ReceiverPool::threads() const {
  const std::lock_guard lock(mutex_);
  return receivers_.size();
}

}  // namespace rayloc
