// The field along a path: antenna, reflections as Jones matrices, antenna, spreading.
//
// Written in a scalar T, so that with dual numbers the coefficient carries derivatives by the
// vertices, the materials and the orientations.
//
// At each reflection the field is split in the directions perpendicular (te) and parallel (tm) to
// the plane of incidence: e_te = d x n / |d x n|, e_tm = e_te x d. At normal incidence, where the
// plane is undefined, any e_te does, since both parts are then reflected alike.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "engine/base/complex.h"
#include "engine/base/mat3.h"
#include "engine/base/vec3.h"
#include "engine/em/antenna_field.h"
#include "engine/em/slab.h"

namespace rayloc {

template <typename T>
struct Reflector {
  Vec3<T> normal;  // either way round
  Complex<T> relative_permittivity;
  T thickness{};  // infinite: half space
};

template <typename T>
struct LinkEnd {
  AntennaPattern pattern = AntennaPattern::kIsotropic;
  Polarization polarization = Polarization::kVertical;
  Mat3<T> world_from_antenna;
};

template <typename T>
struct PathCoefficient {
  Complex<T> a;  // Path::a
  T length{};    // [m], unfolded
};

template <typename T>
struct ComplexVec3 {
  Vec3<T> re;
  Vec3<T> im;
};

// The field after a reflection; `in` and `out` are the directions of travel.
template <typename T>
ComplexVec3<T> reflect_field(const ComplexVec3<T>& field,
                             const Vec3<T>& in,
                             const Vec3<T>& out,
                             const Reflector<T>& reflector,
                             const T& wavelength) {
  using std::isinf;
  constexpr double kNormalIncidence = 1e-18;  // |d x n|^2
  const T along = dot(in, reflector.normal);
  const bool from_front = along < T(0);
  const Vec3<T> normal = from_front ? reflector.normal : -reflector.normal;
  const T cos_theta_i = from_front ? -along : along;

  const Vec3<T> across = cross(in, normal);
  Vec3<T> e_te;
  if (dot(across, across) > T(kNormalIncidence)) {
    e_te = normalized(across);
  } else {
    const bool steep = normal.z * normal.z > T(0.5);
    e_te = normalized(cross(normal, steep ? Vec3<T>{T(1), T(0), T(0)} : Vec3<T>{T(0), T(0), T(1)}));
  }
  const SlabCoefficients<T> slab =
      isinf(reflector.thickness)
          ? half_space_coefficients(cos_theta_i, reflector.relative_permittivity)
          : slab_coefficients(
                cos_theta_i, reflector.relative_permittivity, reflector.thickness, wavelength);
  const Vec3<T> e_tm_in = cross(e_te, in);
  const Vec3<T> e_tm_out = cross(e_te, out);
  const Complex<T> te = slab.r_te * Complex<T>{dot(field.re, e_te), dot(field.im, e_te)};
  const Complex<T> tm = slab.r_tm * Complex<T>{dot(field.re, e_tm_in), dot(field.im, e_tm_in)};
  return {te.re * e_te + tm.re * e_tm_out, te.im * e_te + tm.im * e_tm_out};
}

// REQUIRES: vertices.size() == reflectors.size() + 2, transmitter first, no two successive ones at
// the same place.
template <typename T>
PathCoefficient<T> path_coefficient(std::span<const Vec3<T>> vertices,
                                    std::span<const Reflector<T>> reflectors,
                                    const LinkEnd<T>& transmitter,
                                    const LinkEnd<T>& receiver,
                                    const T& wavelength) {
  const auto segment = [&](std::size_t i) { return vertices[i + 1] - vertices[i]; };
  T length = norm(segment(0));
  Vec3<T> direction = (T(1) / length) * segment(0);
  ComplexVec3<T> field{
      antenna_field(
          transmitter.pattern, transmitter.polarization, transmitter.world_from_antenna, direction),
      {}};
  for (std::size_t i = 0; i < reflectors.size(); ++i) {
    const Vec3<T> leaving = segment(i + 1);
    const T step = norm(leaving);
    const Vec3<T> out = (T(1) / step) * leaving;
    field = reflect_field(field, direction, out, reflectors[i], wavelength);
    direction = out;
    length = length + step;
  }
  const Vec3<T> response = antenna_field(
      receiver.pattern, receiver.polarization, receiver.world_from_antenna, -direction);
  const T spreading = wavelength / (T(4.0 * std::numbers::pi) * length);
  return {{spreading * dot(field.re, response), spreading * dot(field.im, response)}, length};
}

}  // namespace rayloc
