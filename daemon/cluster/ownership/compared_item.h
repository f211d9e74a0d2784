// What of a result has to be the same where two have computed it.
#pragma once

#include <cstdint>
#include <string>

#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

enum class Likeness : std::uint8_t {
  kSameBytes,  // of two that began at the same place, told the same
  // Of two that did not: the same snapshots are at the same instants. Positions differ a little,
  // and so do tracks.
  kSameSnapshots,
};

// Two results are alike where these texts are the same; an empty one is not looked at.
std::string compared(const v1::OutputItem& item, Likeness likeness);

}  // namespace rayloc
