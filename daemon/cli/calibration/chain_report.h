// New chain gains on stderr: how each chain was learned, and its change.
#pragma once

#include "daemon/lab/calibrate/calibrate_rechain.h"

namespace rayloc::cli {

// `with_refused`: first lists the access points that keep their gains.
void print_chains(const RechainResult& result, bool with_refused);

}  // namespace rayloc::cli
