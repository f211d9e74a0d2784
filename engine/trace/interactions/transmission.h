// Transmission: the wave passes straight through a face to its other side.
//
// With q = (d x n) x d the field is
//   t_te E + (t_tm - t_te) / sin^2 (E . q) q.
//
// It is found where a segment between two mirrors meets a face (TraceContext::crossings).
#pragma once

#include "engine/trace/interactions/wave.h"

namespace rayloc::interactions {

struct Transmission {
  static constexpr char kLetter = 'T';        // used in reports
  static constexpr bool kIsMirror = false;    // is_mirror() of this kind
  static constexpr bool kGoesThrough = true;  // goes_through() of this kind
  static constexpr bool kIsEdge = false;      // is_edge() of this kind

  // Coefficients for a wave with that cosine of incidence.
  template <typename T>
  static SlabTable::Pair<T> coefficients(const T& cos_theta_i,
                                         const Facet<T>& facet,
                                         const T& wavelength) {
    if (has_table_at(cos_theta_i, facet)) {
      return facet.table->transmission(cos_theta_i);
    }
    const SlabCoefficients<T> slab = facet_coefficients(cos_theta_i, facet, wavelength);
    return {slab.t_te, slab.t_excess};
  }

  // The wave on the other side.
  template <typename T>
  static Wave<T> apply(const Wave<T>& in, const Facet<T>& facet, const T& wavelength);
};

template <typename T>
Wave<T> Transmission::apply(const Wave<T>& in, const Facet<T>& facet, const T& wavelength) {
  const SlabTable::Pair<T> slab =
      coefficients(cosine_of_incidence(in.direction, facet), facet, wavelength);
  const Vec3<T> q = cross(cross(in.direction, facet.plane.normal), in.direction);
  return {slab.te * in.field + rotated(in.field, q, q, slab.excess), in.direction};
}

}  // namespace rayloc::interactions
