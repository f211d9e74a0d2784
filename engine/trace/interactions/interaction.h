// The one switch over the kinds of interaction, and what all of them answer.
//
// Whoever asks what an interaction does, asks here: a kind that a visitor does not take or that
// lacks an answer does not compile, and neither does one that the switch does not name
// (-Werror=switch).
#pragma once

#include "engine/base/check.h"
#include "engine/trace/interactions/diffraction.h"
#include "engine/trace/interactions/interaction_kind.h"
#include "engine/trace/interactions/reflection.h"
#include "engine/trace/interactions/shadowing.h"
#include "engine/trace/interactions/transmission.h"

namespace rayloc {

#pragma GCC diagnostic push
#pragma GCC diagnostic error "-Wswitch"

// visitor(interactions::Reflection{}), or Transmission{}, Shadowing{} or Diffraction{}, which say
// what the kind does. Inlined it is a branch by the kind, as the comparisons would be that it
// stands for.
template <typename Visitor>
constexpr decltype(auto) visit_interaction(InteractionKind kind, const Visitor& visitor) {
  switch (kind) {
    case InteractionKind::kReflection:
      return visitor(interactions::Reflection{});
    case InteractionKind::kTransmission:
      return visitor(interactions::Transmission{});
    case InteractionKind::kShadowing:
      return visitor(interactions::Shadowing{});
    case InteractionKind::kDiffraction:
      return visitor(interactions::Diffraction{});
  }
  check_failed("an interaction is of a kind that there is", __FILE__, __LINE__);
}

#pragma GCC diagnostic pop

// As reports write it.
constexpr char letter_of(InteractionKind kind) {
  return visit_interaction(kind, [](auto met) { return decltype(met)::kLetter; });
}

// Whether what lies before the surface is seen in it as in a mirror: the path turns there, and is
// straight towards the mirror's image (image_method.h). Otherwise it goes straight on.
constexpr bool is_mirror(InteractionKind kind) {
  return visit_interaction(kind, [](auto met) { return decltype(met)::kIsMirror; });
}

// Whether the path bends at an edge, anywhere but where an image would have it (edge_path.h).
constexpr bool is_edge(InteractionKind kind) {
  return visit_interaction(kind, [](auto met) { return decltype(met)::kIsEdge; });
}

// Whether the wave goes through the face.
constexpr bool goes_through(InteractionKind kind) {
  return visit_interaction(kind, [](auto met) { return decltype(met)::kGoesThrough; });
}

}  // namespace rayloc
