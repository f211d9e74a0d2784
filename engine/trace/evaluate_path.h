// evaluate_path: the coefficient of a path whose interactions are known, in a scalar T.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/base/check.h"
#include "engine/trace/field_calculator.h"
#include "engine/trace/path.h"
#include "engine/trace/soft_path.h"
#include "engine/trace/trace_context.h"

namespace rayloc {

// `facets[i]` is the surface of interactions[i], which may be moved or changed by little: which
// surfaces the path meets stays as it is.
// REQUIRES: facets.size() == interactions.size().
template <typename T>
PathCoefficient<T> evaluate_path(const TraceContext& context,
                                 std::span<const Interaction> interactions,
                                 std::span<const Facet<T>> facets,
                                 const LinkEnd<T>& transmitter,
                                 const LinkEnd<T>& receiver) {
  RAYLOC_CHECK(facets.size() == interactions.size());
  const T wavelength(context.wavelength);
  if (context.options.softness > 0.0) {
    std::vector<SoftInteraction<T>> soft;
    soft.reserve(facets.size());
    for (std::size_t i = 0; i < facets.size(); ++i) {
      soft.push_back(
          {interactions[i].kind, &context.scene->surfaces()[interactions[i].surface], facets[i]});
    }
    return SoftPath<T>(soft, transmitter, receiver, wavelength, context.options).coefficient();
  }
  return path_coefficient<T>(interactions, facets, transmitter, receiver, wavelength);
}

}  // namespace rayloc
