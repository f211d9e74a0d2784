// evaluate_path: the coefficient of a path with given interactions, in a scalar T.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "engine/trace/diffraction/edge_pair_path.h"
#include "engine/trace/diffraction/edge_path.h"
#include "engine/trace/field_calculator.h"
#include "engine/trace/path.h"
#include "engine/trace/soft_path.h"
#include "engine/trace/trace_context.h"

namespace rayloc {

// `facet_of(surface)` returns a Facet<T>, with small displacements or changes: the sequence of
// surfaces that the path meets is fixed.
template <typename T, typename FacetOf>
PathCoefficient<T> evaluate_path(const TraceContext& context,
                                 std::span<const Interaction> interactions,
                                 const FacetOf& facet_of,
                                 const LinkEnd<T>& transmitter,
                                 const LinkEnd<T>& receiver) {
  const T wavelength(context.wavelength);
  if (context.options.softness > 0.0) {
    std::vector<SoftInteraction<T>> soft;
    soft.reserve(interactions.size());
    for (const Interaction& interaction : interactions) {
      soft.push_back(soft_interaction<T>(context, interaction.kind, interaction.surface, facet_of));
      soft.back().at_mirror = interaction.at_mirror;
    }
    return SoftPath<T>(soft, transmitter, receiver, wavelength, context.options).coefficient();
  }
  // Nearly every path fits; a heap allocation would cost more than the path.
  constexpr std::size_t kInline = 8;
  std::array<Facet<T>, kInline> few;
  std::vector<Facet<T>> many;
  if (interactions.size() > kInline) {
    many.resize(interactions.size());
  }
  const std::span<Facet<T>> facets =
      many.empty() ? std::span(few).first(interactions.size()) : std::span(many);
  for (std::size_t i = 0; i < interactions.size(); ++i) {
    facets[i] = facet_of(interactions[i].surface);
  }
  if (context.options.diffraction) {
    const auto next_edge = [&](std::size_t from) {
      return std::find_if(interactions.begin() + static_cast<std::ptrdiff_t>(from),
                          interactions.end(),
                          [](const Interaction& one) { return is_edge(one.kind); });
    };
    const auto at = [&](auto found) {
      return EdgeOfPath<T>{context.wedge(found->edge),
                           facet_of(context.wedges[found->edge].face_n),
                           static_cast<std::size_t>(found - interactions.begin())};
    };
    const std::pair<const LinkEnd<T>&, const LinkEnd<T>&> ends{transmitter, receiver};
    if (const auto first = next_edge(0); first != interactions.end()) {
      const EdgeOfPath<T> one = at(first);
      const auto second = next_edge(one.place + 1);
      return second == interactions.end()
                 ? edge_path<T>(one, interactions, facets, ends, wavelength)
                 : edge_pair_path<T>({one, at(second)}, interactions, facets, ends, wavelength);
    }
  }
  return path_coefficient<T>(interactions, facets, transmitter, receiver, wavelength);
}

}  // namespace rayloc
