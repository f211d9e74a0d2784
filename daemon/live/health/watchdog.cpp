#include "daemon/live/health/watchdog.h"

#include <utility>

namespace rayloc {

Watchdog::Watchdog(std::vector<Stage> stages, std::chrono::milliseconds patience)
    : patience_(patience) {
  for (Stage& stage : stages) {
    seen_.push_back({std::move(stage), 0, {}});
  }
}

std::vector<Watchdog::Stuck> Watchdog::check(Time now) {
  std::vector<Stuck> stuck;
  for (Seen& seen : seen_) {
    const std::uint64_t beats = seen.stage.progress->beats();
    if (first_ || beats != seen.beats || seen.stage.progress->resting()) {
      seen.beats = beats;
      seen.advanced = now;
    } else if (now - seen.advanced >= patience_) {
      stuck.push_back({seen.stage.name,
                       std::chrono::duration_cast<std::chrono::milliseconds>(now - seen.advanced)});
    }
  }
  first_ = false;
  return stuck;
}

}  // namespace rayloc
