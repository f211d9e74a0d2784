// Removes a decommissioned site from the cluster, and allows a later site of its name.
//
// The processes that fetch applied sites are notified first. Once no worker has the site, its
// stream is deleted. Its published messages stay for as long as results are kept, and so does the
// generation of its last claim, for a later site of that name.
#pragma once

#include <string>

#include "daemon/live/cluster/broker.h"
#include "engine/base/expected.h"

namespace rayloc {

// Waits up to 30 s for its worker to give it back. kUnavailable: there is
// no such site, a worker keeps it, or it was claimed meanwhile.
Expected<void> remove_site(Broker& broker, const std::string& site);

// For a site that is applied again: workers claim no site that was recently removed.
Expected<void> reopen_claim(Broker& broker, const std::string& site);

}  // namespace rayloc
