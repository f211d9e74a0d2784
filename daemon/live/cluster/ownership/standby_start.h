// Start of the computation of a standby for a site.
//
// Tracks are not carried from worker to worker: only a worker with the start and the carried state
// of the owner computes the same bytes. So the place of the owner's Begin is taken while the site's
// stream still contains it, and it is at most a minute back. A later standby begins at the last
// record, as at a take-over: its tracks have the same numbers, and their positions differ a little.
#pragma once

#include <string>

#include "daemon/live/cluster/broker.h"
#include "daemon/live/cluster/site_start.h"
#include "engine/base/expected.h"

namespace rayloc {

struct StandbyStart {
  SiteStart start;  // `generation`: the owner's
  bool is_late = false;
};

// An Error where the site has no owner, according to results, or the broker does not answer.
Expected<StandbyStart> standby_start(Broker& broker, const std::string& site);

}  // namespace rayloc
