// Readiness: whether raylocd does what it is there for, and if not, why. What /readyz, `rayloc
// status` and `rayloc wait-ready` say.
#pragma once

#include <string>
#include <vector>

#include "daemon/pipeline/publisher_stage.h"

namespace rayloc {

struct Readiness {
  std::vector<std::string> reasons;   // against being ready; empty: ready
  std::vector<std::string> warnings;  // worth a look, but positions are right
  bool ready() const { return reasons.empty(); }
};

// What is known besides the counters.
struct ServiceHealth {
  std::vector<std::string> stuck_stages;
  std::vector<std::string> recording_errors;
  bool reload_failed = false;
  bool clock_synchronized = true;
};

// Sources that are silent, have failed or count wrongly; and what `health` says.
Readiness readiness(const StatusMessages& status, const ServiceHealth& health);

// {"ready":false,"reasons":["source ap1: ..."],"warnings":[]}
std::string to_json(const Readiness& readiness);

// By adjtimex(2): somebody (chrony, timesyncd) keeps this machine's clock right.
bool clock_is_synchronized();

}  // namespace rayloc
