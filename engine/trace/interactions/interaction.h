// The one switch over the kinds of interaction, and the properties of each kind.
//
// All code that depends on the kind of an interaction uses this file: a kind that a visitor does
// not handle or that lacks a property does not compile, and neither does one that the switch does
// not name (-Werror=switch).
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

// visitor(interactions::Reflection{}), or Transmission{}, Shadowing{} or Diffraction{},
// which have the properties of the kind. Inlined it is a branch by the kind, equivalent to
// explicit comparisons.
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

// The letter used in reports.
constexpr char letter_of(InteractionKind kind) {
  return visit_interaction(kind, [](auto met) { return decltype(met)::kLetter; });
}

// True if the path is mirrored at the surface: it is straight towards the mirror's image
// (image_method.h). Otherwise its direction does not change.
constexpr bool is_mirror(InteractionKind kind) {
  return visit_interaction(kind, [](auto met) { return decltype(met)::kIsMirror; });
}

// True if the path bends at an edge, which is not described by an image (edge_path.h).
constexpr bool is_edge(InteractionKind kind) {
  return visit_interaction(kind, [](auto met) { return decltype(met)::kIsEdge; });
}

// True if the wave passes through the face.
constexpr bool goes_through(InteractionKind kind) {
  return visit_interaction(kind, [](auto met) { return decltype(met)::kGoesThrough; });
}

}  // namespace rayloc
