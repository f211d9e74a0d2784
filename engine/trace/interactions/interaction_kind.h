// InteractionKind: the effect of a surface on a wave at a point of its path.
//
// Each kind is a file of this folder; interaction.h has the one switch over them.
#pragma once

#include <cstdint>

namespace rayloc {

enum class InteractionKind : std::uint8_t {
  kReflection,
  kTransmission,  // straight through one face; a wall has two
  kShadowing,     // past the edge of an opaque surface, under soft visibility
  kDiffraction,   // round the edge of a wedge
};

}  // namespace rayloc
