#include "engine/em/antenna_hash.h"
#include "engine/base/constants.h"

#include <cstdint>

namespace rayloc {

void add_antenna(ContentHash& hash, const AntennaPattern& pattern, Polarization polarization) {
  hash.add(static_cast<std::uint64_t>(pattern.kind()));
  hash.add(static_cast<std::uint64_t>(polarization));
  if (pattern.kind() != AntennaPattern::kTable) {
    return;
  }
  // A table is smooth between its samples, which are at most one degree apart.
  for (int theta = 0; theta <= 180; ++theta) {
    for (int phi = 0; phi < 360; ++phi) {
      hash.add(pattern.table().at(theta * kDegree, phi * kDegree).dbi);
    }
  }
}

}  // namespace rayloc
