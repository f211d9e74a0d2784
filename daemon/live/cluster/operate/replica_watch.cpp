#include "daemon/live/cluster/operate/replica_watch.h"

#include <pthread.h>

#include <algorithm>
#include <utility>

#include "daemon/live/cluster/operate/stream_admin.h"

namespace rayloc {
namespace {

// Between tries while no server answers.
constexpr Duration kReplicaRetry = std::chrono::seconds(1);

}  // namespace

void ReplicaWatch::start() {
  thread_ = std::thread([this] { run(); });
}

void ReplicaWatch::run() {
  pthread_setname_np(pthread_self(), "replicas");  // for top -H
  std::unique_lock lock(mutex_);
  while (!finishing_) {
    progress_.beat();
    lock.unlock();
    std::optional<std::map<std::string, std::size_t>> faults;
    if (broker_->connected()) {
      if (const auto streams = streams_of(*broker_)) {
        faults.emplace();
        for (const StreamReport& stream : *streams) {
          (*faults)[stream.options.name] = stream.troubles.size();
        }
      }
    }
    lock.lock();
    faults_ = std::move(faults);
    progress_.rest();
    wake_.wait_for(
        lock, faults_ ? every_ : std::min(kReplicaRetry, every_), [&] { return finishing_; });
  }
  progress_.rest();
}

std::optional<std::map<std::string, std::size_t>> ReplicaWatch::faults() const {
  const std::lock_guard lock(mutex_);
  return faults_;
}

void ReplicaWatch::finish() {
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) {
    thread_.join();
  }
}

}  // namespace rayloc
