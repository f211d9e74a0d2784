#include "daemon/pipeline/publisher_stage.h"

#include <algorithm>
#include <utility>

#include "daemon/publish/csi_message.h"
#include "daemon/publish/location_message.h"
#include "daemon/publish/topic.h"

namespace rayloc {

PublisherStage::PublisherStage(Publisher publisher, Options options)
    : publisher_(std::move(publisher)),
      options_(std::move(options)),
      heartbeat_(options_.heartbeat.count()) {}

PublisherStage::~PublisherStage() { halt(); }

void PublisherStage::halt() {
  {
    const std::lock_guard lock(mutex_);
    finishing_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void PublisherStage::start() {
  thread_ = std::thread([this] { run(); });
}

void PublisherStage::location(Location&& location) {
  {
    const std::lock_guard lock(mutex_);
    std::uint32_t coalesced = 0;
    if (waiting_.size() >= options_.max_waiting) {
      const auto same = std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& waiting) {
        return waiting.location.is_filtered() == location.is_filtered() &&
               target_component(waiting.location.target) == target_component(location.target);
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

void PublisherStage::keep(Event&& event) {
  {
    const std::lock_guard lock(mutex_);
    if (events_.size() >= options_.max_waiting) {
      events_.pop_front();
      ++counters_.events_dropped;
    }
    events_.push_back(std::move(event));
  }
  wake_.notify_one();
}

void PublisherStage::tap(const std::string& access_point, std::span<const CsiFrame> frames) {
  {
    const std::lock_guard lock(mutex_);
    for (const CsiFrame& frame : frames) {
      if (csi_.size() >= options_.max_waiting_csi) {
        csi_.pop_front();
        ++counters_.csi_dropped;
      }
      csi_.push_back({access_point, frame});
    }
  }
  wake_.notify_one();
}

void PublisherStage::publish_csi(std::deque<WaitingCsi>& frames) {
  for (const WaitingCsi& waiting : frames) {
    publisher_.publish(
        csi_message(waiting.frame, waiting.access_point, options_.name(waiting.frame)),
        options_.now());
  }
  frames.clear();
}

void PublisherStage::run() {
  auto next_status = std::chrono::steady_clock::now();
  std::deque<Waiting> publishing;
  std::deque<Event> events;
  std::deque<WaitingCsi> csi;
  bool finishing = false;
  while (!finishing) {
    progress_.beat();
    {
      std::unique_lock lock(mutex_);
      progress_.rest();
      wake_.wait_until(lock, next_status, [&] {
        return finishing_ || !waiting_.empty() || !events_.empty() || !csi_.empty();
      });
      progress_.beat();
      std::swap(publishing, waiting_);
      std::swap(events, events_);
      std::swap(csi, csi_);
      finishing = finishing_;
    }
    const Duration ahead = options_.clock_ahead ? options_.clock_ahead() : Duration::zero();
    for (const Waiting& waiting : publishing) {
      publisher_.publish(
          location_message(waiting.location, ahead), options_.now(), waiting.coalesced);
    }
    publishing.clear();
    for (const Event& event : events) {
      std::visit(
          [&](const auto& one) { publisher_.publish(event_message(one, ahead), options_.now()); },
          event);
    }
    events.clear();
    publish_csi(csi);
    note_published();
    if (finishing || std::chrono::steady_clock::now() >= next_status) {
      publish_status();
      next_status = std::chrono::steady_clock::now() + Duration(heartbeat_);
    }
  }
  progress_.rest();
}

void PublisherStage::note_published() {
  const PublishedCounters published = publisher_.counters();
  const std::lock_guard lock(mutex_);
  counters_.published = published;
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
  halt();
  v1::Goodbye goodbye;
  goodbye.set_reason(reason);
  publisher_.publish(std::move(goodbye), options_.now());
}

PublisherStageCounters PublisherStage::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace rayloc
