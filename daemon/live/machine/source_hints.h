// Faults in an access point's configuration, detected from its frames: messages of `rayloc doctor`
// about a running daemon's sources.
#pragma once

#include <vector>

#include "daemon/live/machine/machine_check.h"
#include "daemon/site/model/site.h"
#include "rayloc/v1/source.pb.h"

namespace rayloc {

// Silence; another format than the site states; datagrams that are no CSI; chains that are missing,
// have low power, or are not in the site; another bandwidth than the site's. Empty without faults.
std::vector<Finding> source_hints(const v1::SourceState& source, const Site& site);

}  // namespace rayloc
