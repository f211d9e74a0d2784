// From where a worker computes along with the owner of a site.
//
// Tracks are not carried from worker to worker: only who begins where the owner began, and is told
// the same, computes the same bytes. So the place of the owner's Begin is taken while the site's
// stream still has it, and it is at most a minute back. Who comes later begins at the last word, as
// at a take-over: its tracks have the same numbers, and their positions differ a little.
#pragma once

#include <string>

#include "daemon/cluster/broker.h"
#include "daemon/cluster/site_start.h"
#include "engine/base/expected.h"

namespace rayloc {

struct StandbyStart {
  SiteStart start;  // `generation`: the owner's
  bool is_late = false;
};

// An Error where nobody owns the site, as far as results tell, or the broker does not answer.
Expected<StandbyStart> standby_start(Broker& broker, const std::string& site);

}  // namespace rayloc
