// Part of a result that must be equal when two workers have computed it.
#pragma once

#include <cstdint>
#include <string>

#include "rayloc/v1/cluster.pb.h"

namespace rayloc {

enum class Likeness : std::uint8_t {
  kSameBytes,  // for two with the same start and the same carried state
  // For two with different starts: the same snapshots at the
  // same instants. Positions differ a little, and so do tracks.
  kSameSnapshots,
};

// Two results are equal where these texts are the same; an empty text is not compared.
std::string compared(const v1::OutputItem& item, Likeness likeness);

}  // namespace rayloc
