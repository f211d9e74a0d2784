// What an antenna is, for hashes of what depends on it: caches, the inputs of a calibration.
#pragma once

#include "engine/base/content_hash.h"
#include "engine/em/antenna_pattern.h"

namespace rayloc {

void add_antenna(ContentHash& hash, const AntennaPattern& pattern, Polarization polarization);

}  // namespace rayloc
