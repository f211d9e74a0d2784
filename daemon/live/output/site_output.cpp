#include "daemon/live/output/site_output.h"

#include <algorithm>
#include <utility>

#include "daemon/messages/topic.h"

namespace rayloc {

// True: `most` were waiting, and one was replaced.
bool SiteOutput::keep(Location&& location, std::size_t most, std::deque<WaitingLocation>& waiting) {
  std::uint32_t coalesced = 0;
  const bool is_full = waiting.size() >= most;
  if (is_full) {
    const auto same = std::find_if(waiting.begin(), waiting.end(), [&](const WaitingLocation& one) {
      return one.location.is_filtered() == location.is_filtered() &&
             one.location.context.method == location.context.method &&
             target_component(one.location.target) == target_component(location.target);
    });
    // With more targets than places the oldest of another target is removed; it counts as well.
    const auto replaced = same == waiting.end() ? waiting.begin() : same;
    coalesced = same == waiting.end() ? 0 : replaced->coalesced + 1;
    waiting.erase(replaced);
  }
  waiting.push_back({std::move(location), coalesced});
  return is_full;
}

void SiteOutput::location(Location&& location) {
  {
    const std::lock_guard lock(mutex_);
    if (keep(std::move(location), options_.max_waiting, waiting_.locations)) {
      ++counters_.coalesced;
    }
  }
  wake_();
}

bool SiteOutput::compared(Location&& location) {
  bool is_replaced = false;
  {
    const std::lock_guard lock(compared_mutex_);
    is_replaced = keep(std::move(location), options_.max_waiting, compared_);
  }
  wake_();
  return is_replaced;
}

void SiteOutput::keep(Event&& event) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.events.size() >= options_.max_waiting) {
      waiting_.events.pop_front();
      ++counters_.events_dropped;
    }
    waiting_.events.push_back(std::move(event));
  }
  wake_();
}

void SiteOutput::relay(Message&& message) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.messages.size() >= options_.max_waiting) {
      waiting_.messages.pop_front();
      ++counters_.events_dropped;
    }
    waiting_.messages.push_back(std::move(message));
  }
  wake_();
}

void SiteOutput::tap(const std::string& access_point, std::span<const CsiFrame> frames) {
  {
    const std::lock_guard lock(mutex_);
    for (const CsiFrame& frame : frames) {
      if (waiting_.csi.size() >= options_.max_waiting_csi) {
        waiting_.csi.pop_front();
        ++counters_.csi_dropped;
      }
      waiting_.csi.push_back({access_point, frame});
    }
  }
  wake_();
}

SiteOutput::Waiting SiteOutput::take() {
  Waiting waiting;
  {
    const std::lock_guard lock(mutex_);
    waiting = std::exchange(waiting_, {});
  }
  // If the lock is held, its holder is about to call wake_().
  if (const std::unique_lock lock(compared_mutex_, std::try_to_lock); lock.owns_lock()) {
    waiting.compared = std::exchange(compared_, {});
  }
  return waiting;
}

std::optional<StatusMessages> SiteOutput::report(Timestamp now) {
  const std::lock_guard lock(status_mutex_);
  return closed_ ? std::nullopt : std::optional(options_.status(now));
}

void SiteOutput::close() {
  const std::lock_guard lock(status_mutex_);
  closed_ = true;
}

void SiteOutput::note_published(const PublishedCounters& published) {
  const std::lock_guard lock(mutex_);
  counters_.published = published;
}

SiteOutputCounters SiteOutput::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace rayloc
