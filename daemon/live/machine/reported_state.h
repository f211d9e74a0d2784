// Findings about a running raylocd from its answers over HTTP, or from their absence: messages of
// `rayloc doctor`.
#pragma once

#include <sys/types.h>

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "daemon/live/machine/machine_check.h"
#include "daemon/site/model/site.h"

namespace rayloc {

// Faults of the sources. `sources`: the answer of /api/v1/sources. See source_hints().
std::vector<Finding> source_findings(const nlohmann::json& sources, const Site& site);

// Adds the reasons and warnings of /readyz, except those that are in `findings`, of the clock,
// which check_machine() examines, and, with `has_sources`, of sources, which source_findings() has.
// With several sites, /readyz prefixes each problem with its site.
void add_readiness(const nlohmann::json& ready, bool has_sources, std::vector<Finding>& findings);

// The finding for a daemon that runs and does not answer.
Finding silent_daemon(pid_t process, bool has_http);

}  // namespace rayloc
