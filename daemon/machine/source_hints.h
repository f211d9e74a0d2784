// What is wrong with an access point's configuration, by what comes from it: what `rayloc doctor`
// says of a running daemon's sources.
#pragma once

#include <vector>

#include "daemon/machine/machine_check.h"
#include "daemon/site/site.h"
#include "rayloc/v1/source.pb.h"

namespace rayloc {

// Silence; another format than the site states; datagrams that are no CSI; chains that are missing,
// deaf, or unknown to the site; another bandwidth than the site's. Empty when all is well.
std::vector<Finding> source_hints(const v1::SourceState& source, const Site& site);

}  // namespace rayloc
