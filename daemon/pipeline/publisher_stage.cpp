#include "daemon/pipeline/publisher_stage.h"

#include <algorithm>
#include <utility>

#include "daemon/publish/topic.h"

namespace rayloc {

PublisherStage::PublisherStage(Publisher publisher, Options options)
    : publisher_(std::move(publisher)), options_(std::move(options)) {}

PublisherStage::~PublisherStage() {
  if (thread_.joinable()) {
    finish("stopped");
  }
}

void PublisherStage::start() {
  thread_ = std::thread([this] { run(); });
}

void PublisherStage::location(v1::Location&& location) {
  {
    const std::lock_guard lock(mutex_);
    std::uint32_t coalesced = 0;
    if (waiting_.size() >= options_.max_waiting) {
      const auto same = std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& waiting) {
        return waiting.location.kind() == location.kind() &&
               target_component(waiting.location.target()) == target_component(location.target());
      });
      // With more targets than places the oldest of another one has to go: it counts as well.
      const auto replaced = same == waiting_.end() ? waiting_.begin() : same;
      coalesced = same == waiting_.end() ? 0 : replaced->coalesced + 1;
      waiting_.erase(replaced);
      ++counters_.coalesced;
    }
    waiting_.push_back({std::move(location), coalesced});
  }
  wake_.notify_one();
}

void PublisherStage::run() {
  auto next_status = std::chrono::steady_clock::now();
  std::deque<Waiting> publishing;
  bool finishing = false;
  while (!finishing) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait_until(lock, next_status, [&] { return finishing_ || !waiting_.empty(); });
      std::swap(publishing, waiting_);
      finishing = finishing_;
    }
    for (const Waiting& waiting : publishing) {
      publisher_.publish(waiting.location, options_.now(), waiting.coalesced);
    }
    publishing.clear();
    if (finishing || std::chrono::steady_clock::now() >= next_status) {
      publish_status();
      next_status = std::chrono::steady_clock::now() + options_.heartbeat;
    }
  }
}

void PublisherStage::publish_status() {
  const Timestamp now = options_.now();
  StatusMessages status = options_.status(now);
  for (const v1::SourceState& source : status.sources) {
    publisher_.publish(source, now);
  }
  publisher_.publish(std::move(status.heartbeat), now);
}

void PublisherStage::finish(const std::string& reason) {
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) {
    thread_.join();
  }
  v1::Goodbye goodbye;
  goodbye.set_reason(reason);
  publisher_.publish(std::move(goodbye), options_.now());
}

PublisherStageCounters PublisherStage::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace rayloc
