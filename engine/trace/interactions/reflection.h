// Reflection: the wave is reflected at a face.
//
// With q = (d x n) x d, q_out the same for the outgoing direction and M the
// mirror, the field is
//   r_te M(E) + (r_te + r_tm) / sin^2 (E . q) q_out.
//
// It is found by the images of the receiver (images/image_tree.h), which also give its position.
#pragma once

#include "engine/trace/interactions/wave.h"

namespace rayloc::interactions {

struct Reflection {
  static constexpr char kLetter = 'R';         // used in reports
  static constexpr bool kIsMirror = true;      // is_mirror() of this kind
  static constexpr bool kGoesThrough = false;  // goes_through() of this kind
  static constexpr bool kIsEdge = false;       // is_edge() of this kind

  // Coefficients for a wave with that cosine of incidence, and for a face without roughness.
  template <typename T>
  static SlabTable::Pair<T> smooth_coefficients(const T& cos_theta_i,
                                                const Facet<T>& facet,
                                                const T& wavelength) {
    if (has_table_at(cos_theta_i, facet)) {
      return facet.table->reflection(cos_theta_i);
    }
    const SlabCoefficients<T> slab = facet_coefficients(cos_theta_i, facet, wavelength);
    return {slab.r_te, slab.r_excess};
  }
  // Including the roughness of the face.
  template <typename T>
  static SlabTable::Pair<T> coefficients(const T& cos_theta_i,
                                         const Facet<T>& facet,
                                         const T& wavelength) {
    SlabTable::Pair<T> found = smooth_coefficients(cos_theta_i, facet, wavelength);
    if (value_of(facet.specular) != 1.0) {
      const Complex<T> left{facet.specular, T(0)};
      found = {left * found.te, left * found.excess};
    }
    return found;
  }

  // Mirrors a direction.
  template <typename T>
  static Vec3<T> mirrored(const Vec3<T>& v, const Vec3<T>& normal) {
    return v - (T(2) * dot(v, normal)) * normal;
  }

  // The wave that leaves the face.
  template <typename T>
  static Wave<T> apply(const Wave<T>& in, const Facet<T>& facet, const T& wavelength);
};

template <typename T>
Wave<T> Reflection::apply(const Wave<T>& in, const Facet<T>& facet, const T& wavelength) {
  const Vec3<T>& normal = facet.plane.normal;
  const SlabTable::Pair<T> slab =
      coefficients(cosine_of_incidence(in.direction, facet), facet, wavelength);
  const Vec3<T> out = mirrored(in.direction, normal);
  const Vec3<T> across = cross(in.direction, normal);
  const ComplexVec3<T> image{mirrored(in.field.re, normal), mirrored(in.field.im, normal)};
  return {slab.te * image +
              rotated(in.field, cross(across, in.direction), cross(across, out), slab.excess),
          out};
}

}  // namespace rayloc::interactions
