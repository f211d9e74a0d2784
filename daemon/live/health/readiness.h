// Readiness: shows if raylocd fulfils its purpose, and if not, why. Content of /readyz, `rayloc
// status` and `rayloc wait-ready`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/live/config/config.h"
#include "daemon/live/output/site_output.h"
#include "daemon/site/model/site_lacks.h"

namespace rayloc {

// State of the synchronisation of this machine's clock (by chrony, timesyncd).
enum class ClockState { kSynchronized, kNotSynchronized, kUnknown };

struct Readiness {
  std::vector<std::string> reasons;   // against being ready; empty: ready
  std::vector<std::string> warnings;  // worth checking, but positions are correct
  ClockState clock = ClockState::kUnknown;
  bool ready() const { return reasons.empty(); }
};

// Missing data of a site that a daemon with that configuration, which receives some access points
// or all, needs to locate; empty if it is not to locate. REQUIRES: `room` is that of the site.
SiteLacks lacks_of(const SiteSetup& setup, const RoomModel& room);

// Health data besides the counters.
struct ServiceHealth {
  SiteLacks lacks;  // lacks_of()
  std::vector<std::string> stuck_stages;
  std::vector<std::string> saturated;   // Saturation::reasons()
  std::vector<std::string> overloaded;  // Saturation::warnings()
  std::vector<std::string> recording_errors;
  bool reload_failed = false;
  ClockState clock = ClockState::kUnknown;
};

// The part of these that is not published in another message: Heartbeat.warnings.
std::vector<std::string> public_warnings(const ServiceHealth& health);

// Sources that are silent, have failed or count wrongly; and the content of `health`.
Readiness readiness(const StatusMessages& status, const ServiceHealth& health);

// {"ready":false,"reasons":["source ap1: ..."],"warnings":[],"clock":"unknown"}
// The clock is "synchronised", "not synchronised" or "unknown".
std::string to_json(const Readiness& readiness);

// From the kernel's state (adjtimex(2)), which a service with ProtectClock= cannot read; then from
// the mark that systemd-timesyncd leaves. Others leave none: without it the state is unknown.
ClockState clock_state();
// `by_kernel`: synchronised according to the kernel; empty if it gives no answer.
ClockState clock_state(std::optional<bool> by_kernel, bool marked);

}  // namespace rayloc
