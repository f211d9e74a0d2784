// Hash of an antenna's properties, for caches and inputs of a calibration that depend on them.
#pragma once

#include "engine/base/content_hash.h"
#include "engine/em/antenna_pattern.h"

namespace rayloc {

void add_antenna(ContentHash& hash, const AntennaPattern& pattern, Polarization polarization);

}  // namespace rayloc
