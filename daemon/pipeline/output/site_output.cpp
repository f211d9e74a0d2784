#include "daemon/pipeline/output/site_output.h"

#include <algorithm>
#include <utility>

#include "daemon/publish/topic.h"

namespace rayloc {

void SiteOutput::location(Location&& location) {
  {
    const std::lock_guard lock(mutex_);
    std::uint32_t coalesced = 0;
    auto& waiting = waiting_.locations;
    if (waiting.size() >= options_.max_waiting) {
      const auto same =
          std::find_if(waiting.begin(), waiting.end(), [&](const WaitingLocation& one) {
            return one.location.is_filtered() == location.is_filtered() &&
                   target_component(one.location.target) == target_component(location.target);
          });
      // With more targets than places the oldest of another one has to go: it counts as well.
      const auto replaced = same == waiting.end() ? waiting.begin() : same;
      coalesced = same == waiting.end() ? 0 : replaced->coalesced + 1;
      waiting.erase(replaced);
      ++counters_.coalesced;
    }
    waiting.push_back({std::move(location), coalesced});
  }
  wake_();
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

void SiteOutput::say(Message&& message) {
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
  const std::lock_guard lock(mutex_);
  return std::exchange(waiting_, {});
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
