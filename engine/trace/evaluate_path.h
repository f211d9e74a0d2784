// evaluate_path: the coefficient of a path whose interactions are known, in a scalar T.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/trace/field_calculator.h"
#include "engine/trace/path.h"
#include "engine/trace/soft_path.h"
#include "engine/trace/trace_context.h"

namespace rayloc {

// `facet_of(surface)` gives a Facet<T>, moved or changed by little: which surfaces the path meets
// stays as it is.
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
  // Nearly every path fits: the heap would cost more than the path.
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
  return path_coefficient<T>(interactions, facets, transmitter, receiver, wavelength);
}

}  // namespace rayloc
