#include "daemon/live/service/process_health.h"

#include <utility>

namespace rayloc {

void ProcessHealth::note_reload(bool successful, const ConfigValues* values, Timestamp now) {
  const std::lock_guard lock(mutex_);
  reload_failed_ = !successful;
  reloaded_ = now;
  if (values != nullptr) {
    config_json_ = values->json();
  }
}

void ProcessHealth::note_stuck(std::vector<std::string> stages) {
  const std::lock_guard lock(mutex_);
  stuck_stages_ = std::move(stages);
}

std::vector<std::string> ProcessHealth::stuck_stages() const {
  const std::lock_guard lock(mutex_);
  return stuck_stages_;
}

std::string ProcessHealth::config_json() const {
  const std::lock_guard lock(mutex_);
  return config_json_;
}

bool ProcessHealth::reload_failed() const {
  const std::lock_guard lock(mutex_);
  return reload_failed_;
}

void ProcessHealth::fill(ServiceHealth& health, const std::string& label) const {
  const std::lock_guard lock(mutex_);
  for (const std::string& stage : stuck_stages_) {
    if (label.empty() || stage.rfind("site '", 0) != 0 || stage.rfind(label, 0) == 0) {
      health.stuck_stages.push_back(stage);
    }
  }
  health.reload_failed = reload_failed_;
}

std::vector<ExtraMetric> ProcessHealth::metrics() const {
  const std::lock_guard lock(mutex_);
  return {{"rayloc_config_last_reload_successful",
           "0 when the last reload found the configuration wrong",
           false,
           {{"", "", reload_failed_ ? 0.0 : 1.0}}},
          {"rayloc_config_last_reload_timestamp_seconds",
           "When the configuration was last read, in seconds since 1970",
           false,
           {{"", "", to_seconds(reloaded_.time_since_epoch())}}},
          {"rayloc_stages_stuck",
           "Threads that make no progress",
           false,
           {{"", "", static_cast<double>(stuck_stages_.size())}}}};
}

}  // namespace rayloc
