// A plane wave and a face that it meets: the common types of the kinds of interaction.
//
// With e_te = d x n / |d x n| and e_tm = e_te x d, a slab maps a field E to r_te E_te + r_tm E_tm
// or t_te E_te + t_tm E_tm. At normal incidence these directions are undefined and their
// derivatives infinite, so reflection.h and transmission.h use an equivalent form without them.
//
// Written in a scalar T, so that with dual numbers a wave carries derivatives by both ends, the
// planes, the materials and the orientations.
#pragma once

#include <cmath>

#include "engine/base/complex.h"
#include "engine/base/dual.h"
#include "engine/base/vec3.h"
#include "engine/em/slab.h"
#include "engine/em/slab_table.h"
#include "engine/scene/surface.h"

namespace rayloc {

// One face as a wave meets it.
template <typename T>
struct Facet {
  Plane<T> plane;  // normal of either sign
  Complex<T> relative_permittivity;
  T thickness{};    // [m]; infinite: half space
  Vec3<T> shift{};  // [m], of its edges; the plane is displaced separately
  // Table for exactly this permittivity and thickness, neither of which varies; nullptr: none.
  const SlabTable* table = nullptr;
  T specular = T(1);  // share of the reflected field that is not scattered; 1: smooth
};

template <typename T>
struct ComplexVec3 {
  Vec3<T> re;
  Vec3<T> im;
};

template <typename T>
ComplexVec3<T> operator*(const Complex<T>& s, const ComplexVec3<T>& e) {
  return {s.re * e.re - s.im * e.im, s.re * e.im + s.im * e.re};
}
template <typename T>
ComplexVec3<T> operator+(const ComplexVec3<T>& a, const ComplexVec3<T>& b) {
  return {a.re + b.re, a.im + b.im};
}

// A plane wave's polarisation and direction of travel.
template <typename T>
struct Wave {
  ComplexVec3<T> field;
  Vec3<T> direction;  // unit
};

template <typename T>
T cosine_of_incidence(const Vec3<T>& direction, const Facet<T>& facet) {
  const T along = dot(direction, facet.plane.normal);
  return along < T(0) ? -along : along;
}

template <typename T>
SlabCoefficients<T> facet_coefficients(const T& cos_theta_i,
                                       const Facet<T>& facet,
                                       const T& wavelength) {
  using std::isinf;
  return isinf(facet.thickness)
             ? half_space_coefficients(cos_theta_i, facet.relative_permittivity)
             : slab_coefficients(
                   cos_theta_i, facet.relative_permittivity, facet.thickness, wavelength);
}

// True if the face's table applies instead of facet_coefficients().
template <typename T>
bool has_table_at(const T& cos_theta_i, const Facet<T>& facet) {
  return facet.table != nullptr && facet.table->covers(value_of(cos_theta_i));
}

// scale (E . from) to.
template <typename T>
ComplexVec3<T> rotated(const ComplexVec3<T>& e,
                       const Vec3<T>& from,
                       const Vec3<T>& to,
                       const Complex<T>& scale) {
  const Complex<T> along = scale * Complex<T>{dot(e.re, from), dot(e.im, from)};
  return {along.re * to, along.im * to};
}

}  // namespace rayloc
