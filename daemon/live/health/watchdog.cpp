#include "daemon/live/health/watchdog.h"

#include <algorithm>
#include <utility>

namespace rayloc {

Watchdog::Watchdog(std::vector<Stage> stages, std::chrono::milliseconds patience)
    : patience_(patience) {
  replace(std::move(stages));
}

void Watchdog::replace(std::vector<Stage> stages) {
  std::vector<Seen> seen;
  seen.reserve(stages.size());
  for (Stage& stage : stages) {
    const auto before = std::find_if(seen_.begin(), seen_.end(), [&](const Seen& one) {
      return one.stage.progress == stage.progress && one.stage.name == stage.name;
    });
    seen.push_back(before == seen_.end() ? Seen{std::move(stage), 0, {}} : *before);
  }
  seen_ = std::move(seen);
}

std::vector<Watchdog::Stuck> Watchdog::check(Time now) {
  std::vector<Stuck> stuck;
  for (Seen& seen : seen_) {
    const std::uint64_t beats = seen.stage.progress->beats();
    if (!seen.advanced || beats != seen.beats || seen.stage.progress->resting()) {
      seen.beats = beats;
      seen.advanced = now;
    } else if (now - *seen.advanced >= patience_) {
      stuck.push_back(
          {seen.stage.name,
           std::chrono::duration_cast<std::chrono::milliseconds>(now - *seen.advanced)});
    }
  }
  return stuck;
}

}  // namespace rayloc
