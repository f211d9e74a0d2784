// Readiness: whether raylocd does what it is there for, and if not, why. What /readyz, `rayloc
// status` and `rayloc wait-ready` say.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "daemon/config/config.h"
#include "daemon/pipeline/output/site_output.h"
#include "daemon/site/site_lacks.h"

namespace rayloc {

// Whether somebody (chrony, timesyncd) keeps this machine's clock right.
enum class ClockState { kSynchronized, kNotSynchronized, kUnknown };

struct Readiness {
  std::vector<std::string> reasons;   // against being ready; empty: ready
  std::vector<std::string> warnings;  // worth a look, but positions are right
  ClockState clock = ClockState::kUnknown;
  bool ready() const { return reasons.empty(); }
};

// What a daemon with that configuration, which listens to some access points or to all, lacks to
// locate; nothing where it is not to locate. REQUIRES: `room` was loaded of its site.
SiteLacks lacks_of(const SiteSetup& setup, const RoomModel& room);

// What is known besides the counters.
struct ServiceHealth {
  SiteLacks lacks;  // lacks_of()
  std::vector<std::string> stuck_stages;
  std::vector<std::string> saturated;   // Saturation::reasons()
  std::vector<std::string> overloaded;  // Saturation::warnings()
  std::vector<std::string> recording_errors;
  bool reload_failed = false;
  ClockState clock = ClockState::kUnknown;
};

// Of these, what nothing else that is published says: Heartbeat.warnings.
std::vector<std::string> warnings_for_everybody(const ServiceHealth& health);

// Sources that are silent, have failed or count wrongly; and what `health` says.
Readiness readiness(const StatusMessages& status, const ServiceHealth& health);

// {"ready":false,"reasons":["source ap1: ..."],"warnings":[],"clock":"unknown"}
// The clock is "synchronised", "not synchronised" or "unknown".
std::string to_json(const Readiness& readiness);

// By what the kernel says (adjtimex(2)), which a service with ProtectClock= is not told; then by
// the mark that systemd-timesyncd leaves. Others leave none: without it nothing is known.
ClockState clock_state();
// `kernel_says`: that it is synchronised; nothing where it does not answer.
ClockState clock_state(std::optional<bool> kernel_says, bool marked);

}  // namespace rayloc
