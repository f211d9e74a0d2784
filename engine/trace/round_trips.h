// Round trips of a wave between two coincident faces (coplanar_faces.h): the bounces in a gap
// that goes to zero.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/trace/interactions/interaction.h"
#include "engine/trace/path.h"
#include "engine/trace/trace_context.h"

namespace rayloc {

inline bool are_coplanar(const TraceContext& context, std::uint32_t a, std::uint32_t b) {
  const auto& faces = context.coplanar_faces[a];
  return std::any_of(
      faces.begin(), faces.end(), [&](const CoplanarFace& face) { return face.surface == b; });
}

// Calls visit(const std::vector<Interaction>&) for every path that differs from the one of
// `interactions` by such round trips from the interaction `first` on, each of which is two more
// interactions; none beyond the depth.
template <typename Visit>
void visit_round_trips(const TraceContext& context,
                       const std::vector<Interaction>& interactions,
                       std::size_t first,
                       const Visit& visit) {
  if (interactions.size() + 2 > static_cast<std::size_t>(context.options.max_depth)) {
    return;
  }
  for (std::size_t i = first; i + 1 < interactions.size(); ++i) {
    // The wave enters the gap through one face; at the other it leaves or is reflected.
    const Interaction& entered = interactions[i];
    const Interaction& other = interactions[i + 1];
    if (!goes_through(entered.kind) || !are_coplanar(context, entered.surface, other.surface)) {
      continue;
    }
    std::vector<Interaction> bounces{other, entered};
    for (Interaction& bounce : bounces) {
      bounce.kind = InteractionKind::kReflection;
      bounce.at_mirror = false;
    }
    const bool turns_back = is_mirror(other.kind);
    if (turns_back) {
      std::swap(bounces[0], bounces[1]);
    }
    std::vector<Interaction> longer = interactions;
    longer.insert(longer.begin() + static_cast<std::ptrdiff_t>(i + (turns_back ? 2 : 1)),
                  bounces.begin(),
                  bounces.end());
    visit(longer);
    visit_round_trips(context, longer, i, visit);
  }
}

}  // namespace rayloc
