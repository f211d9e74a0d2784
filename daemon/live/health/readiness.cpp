#include "daemon/live/health/readiness.h"

#include <sys/timex.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rayloc {
namespace {

// received = rejected + ring_dropped + processed + in_flight (source.proto).
bool is_conserved(const v1::SourceCounters& counters) {
  std::uint64_t accounted = counters.ring_dropped() + counters.processed() + counters.in_flight();
  for (const auto& [reason, count] : counters.rejected()) {
    accounted += count;
  }
  return counters.received() == accounted;
}

std::string source_trouble(const v1::SourceState& state) {
  const std::string name = "source " + state.access_point() + ": ";
  switch (state.status()) {
    case v1::SOURCE_STATUS_WAITING:
      return name + "nothing has come yet at " + state.description();
    case v1::SOURCE_STATUS_STALLED:
      return name + fmt::format("silent for {} s", state.age().seconds());
    case v1::SOURCE_STATUS_FAILED:
      return name + state.detail();
    default:
      if (!is_conserved(state.counters())) {
        return name + "its datagrams are not accounted for";
      }
      return state.detail().empty() ? "" : name + state.detail();
  }
}

const char* word(ClockState clock) {
  switch (clock) {
    case ClockState::kSynchronized:
      return "synchronised";
    case ClockState::kNotSynchronized:
      return "not synchronised";
    case ClockState::kUnknown:
      break;
  }
  return "unknown";
}

// Empty if the call is denied.
std::optional<bool> synchronized_by_kernel() {
  timex clock{};
  const int state = adjtimex(&clock);
  return state < 0 ? std::nullopt
                   : std::optional<bool>(state != TIME_ERROR && (clock.status & STA_UNSYNC) == 0);
}

}  // namespace

SiteLacks lacks_of(const SiteSetup& setup, const RoomModel& room) {
  if (setup.config.engine.method == nullptr) {
    return {};
  }
  std::vector<std::size_t> received;
  for (const SourceConfig& source : setup.config.sources) {
    received.push_back(source.access_point_index.value());
  }
  return site_lacks(setup.site, room, received);
}

std::vector<std::string> public_warnings(const ServiceHealth& health) {
  std::vector<std::string> all = health.lacks.all();
  for (const auto* some : {&health.saturated, &health.overloaded}) {
    all.insert(all.end(), some->begin(), some->end());
  }
  for (const std::string& error : health.recording_errors) {
    all.push_back("recording: " + error);
  }
  return all;
}

Readiness readiness(const StatusMessages& status, const ServiceHealth& health) {
  Readiness result;
  result.clock = health.clock;
  result.reasons = health.lacks.obstacles;
  for (const v1::SourceState& source : status.sources) {
    if (std::string trouble = source_trouble(source); !trouble.empty()) {
      result.reasons.push_back(std::move(trouble));
    }
  }
  for (const std::string& stage : health.stuck_stages) {
    result.reasons.push_back("stage " + stage + ": no progress");
  }
  result.reasons.insert(result.reasons.end(), health.saturated.begin(), health.saturated.end());
  result.warnings = health.lacks.warnings;
  result.warnings.insert(result.warnings.end(), health.overloaded.begin(), health.overloaded.end());
  for (const std::string& error : health.recording_errors) {
    result.warnings.push_back("recording: " + error);
  }
  if (health.reload_failed) {
    result.warnings.emplace_back("the last reload failed: the configuration is wrong");
  }
  if (health.clock == ClockState::kNotSynchronized) {
    result.warnings.emplace_back("the clock of this machine is not synchronised: times are off");
  }
  for (const std::string& warning : status.heartbeat.calibration_warnings()) {
    result.warnings.push_back("calibration: " + warning);
  }
  return result;
}

std::string to_json(const Readiness& readiness) {
  const nlohmann::ordered_json json = {{"ready", readiness.ready()},
                                       {"reasons", readiness.reasons},
                                       {"warnings", readiness.warnings},
                                       {"clock", word(readiness.clock)}};
  // Names of devices and files may not be valid UTF-8.
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

ClockState clock_state() {
  constexpr const char* kMark = "/run/systemd/timesync/synchronized";
  return clock_state(synchronized_by_kernel(), access(kMark, F_OK) == 0);
}

ClockState clock_state(std::optional<bool> by_kernel, bool marked) {
  if (by_kernel) {
    return *by_kernel ? ClockState::kSynchronized : ClockState::kNotSynchronized;
  }
  return marked ? ClockState::kSynchronized : ClockState::kUnknown;
}

}  // namespace rayloc
