// The field along a path: antenna, reflections and transmissions, antenna, spreading.
//
// Written in a scalar T, so that with dual numbers the coefficient carries derivatives by both
// ends, the planes, the materials and the orientations.
//
// With e_te = d x n / |d x n| and e_tm = e_te x d, a slab turns a field E into r_te E_te + r_tm
// E_tm or t_te E_te + t_tm E_tm. At normal incidence these directions are undefined and their
// derivatives infinite, so the same is written without them: with q = (d x n) x d and M the mirror,
//   reflected   = r_te M(E) + (r_te + r_tm) / sin^2 (E . q_in) q_out,
//   transmitted = t_te E    + (t_tm - t_te) / sin^2 (E . q) q.
//
// The whole path follows from the image of the receiver: which direction the wave leaves in and how
// long it is. Vertices are not needed (image_method.h has them).
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "engine/base/check.h"
#include "engine/base/complex.h"
#include "engine/base/dual.h"
#include "engine/base/mat3.h"
#include "engine/base/vec3.h"
#include "engine/em/antenna_field.h"
#include "engine/em/slab.h"
#include "engine/em/slab_table.h"
#include "engine/scene/surface.h"
#include "engine/trace/image_method.h"
#include "engine/trace/path.h"

namespace rayloc {

// One face as a wave meets it.
template <typename T>
struct Facet {
  Plane<T> plane;  // either way round
  Complex<T> relative_permittivity;
  T thickness{};    // [m]; infinite: half space
  Vec3<T> shift{};  // [m], of its edges; the plane has its own
  // Of exactly this permittivity and thickness, neither of which is varied; nullptr: none.
  const SlabTable* table = nullptr;
};

template <typename T>
struct LinkEnd {
  Vec3<T> position;  // [m], world
  AntennaPattern pattern = AntennaPattern::kIsotropic;
  Polarization polarization = Polarization::kVertical;
  Mat3<T> world_from_antenna;
};

template <typename T>
struct PathCoefficient {
  Complex<T> a;         // Path::a
  T length{};           // [m], unfolded
  Vec3<T> departure{};  // unit, the way that the wave leaves the transmitter
  Vec3<T> arrival{};    // unit, the way that it travels when it arrives
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

// By the table, where there is one.
template <typename T>
SlabTable::Pair<T> facet_pair(const Vec3<T>& direction,
                              const Facet<T>& facet,
                              const T& wavelength,
                              InteractionKind kind) {
  const T cos_theta_i = cosine_of_incidence(direction, facet);
  const bool reflects = kind == InteractionKind::kReflection;
  if (facet.table != nullptr && facet.table->covers(value_of(cos_theta_i))) {
    return reflects ? facet.table->reflection(cos_theta_i) : facet.table->transmission(cos_theta_i);
  }
  const SlabCoefficients<T> slab = facet_coefficients(cos_theta_i, facet, wavelength);
  return reflects ? SlabTable::Pair<T>{slab.r_te, slab.r_excess}
                  : SlabTable::Pair<T>{slab.t_te, slab.t_excess};
}

// (E . from) to, scaled.
template <typename T>
ComplexVec3<T> turned(const ComplexVec3<T>& e,
                      const Vec3<T>& from,
                      const Vec3<T>& to,
                      const Complex<T>& scale) {
  const Complex<T> along = scale * Complex<T>{dot(e.re, from), dot(e.im, from)};
  return {along.re * to, along.im * to};
}

template <typename T>
Vec3<T> mirrored(const Vec3<T>& v, const Vec3<T>& normal) {
  return v - (T(2) * dot(v, normal)) * normal;
}

template <typename T>
Wave<T> reflect(const Wave<T>& in, const Facet<T>& facet, const T& wavelength) {
  const Vec3<T>& normal = facet.plane.normal;
  const SlabTable::Pair<T> slab =
      facet_pair(in.direction, facet, wavelength, InteractionKind::kReflection);
  const Vec3<T> out = mirrored(in.direction, normal);
  const Vec3<T> across = cross(in.direction, normal);
  const ComplexVec3<T> image{mirrored(in.field.re, normal), mirrored(in.field.im, normal)};
  return {slab.te * image +
              turned(in.field, cross(across, in.direction), cross(across, out), slab.excess),
          out};
}

// Straight on to the other face.
template <typename T>
Wave<T> transmit(const Wave<T>& in, const Facet<T>& facet, const T& wavelength) {
  const SlabTable::Pair<T> slab =
      facet_pair(in.direction, facet, wavelength, InteractionKind::kTransmission);
  const Vec3<T> q = cross(cross(in.direction, facet.plane.normal), in.direction);
  return {slab.te * in.field + turned(in.field, q, q, slab.excess), in.direction};
}

// What leaves the transmitter in that direction.
template <typename T>
Wave<T> radiated(const LinkEnd<T>& transmitter, const Vec3<T>& direction) {
  return {{antenna_field(transmitter.pattern,
                         transmitter.polarization,
                         transmitter.world_from_antenna,
                         direction),
           {}},
          direction};
}

// What the receiver makes of a wave after a path of `length` [m].
template <typename T>
Complex<T> received(const LinkEnd<T>& receiver,
                    const Wave<T>& wave,
                    const T& length,
                    const T& wavelength) {
  const Vec3<T> response = antenna_field(
      receiver.pattern, receiver.polarization, receiver.world_from_antenna, -wave.direction);
  const T spreading = wavelength / (T(4.0 * std::numbers::pi) * length);
  return {spreading * dot(wave.field.re, response), spreading * dot(wave.field.im, response)};
}

// The path from transmitter to receiver over `facets`, as `interactions` says.
// REQUIRES: interactions.size() == facets.size(); ends and images are not at the same place.
template <typename T>
PathCoefficient<T> path_coefficient(std::span<const Interaction> interactions,
                                    std::span<const Facet<T>> facets,
                                    const LinkEnd<T>& transmitter,
                                    const LinkEnd<T>& receiver,
                                    const T& wavelength) {
  RAYLOC_CHECK(interactions.size() == facets.size());
  Vec3<T> image = receiver.position;
  for (std::size_t i = facets.size(); i > 0; --i) {
    if (interactions[i - 1].kind == InteractionKind::kReflection) {
      image = mirror(facets[i - 1].plane, image);
    }
  }
  const Vec3<T> unfolded = image - transmitter.position;
  PathCoefficient<T> path;
  path.length = norm(unfolded);
  path.departure = (T(1) / path.length) * unfolded;
  Wave<T> wave = radiated(transmitter, path.departure);
  for (std::size_t i = 0; i < facets.size(); ++i) {
    wave = interactions[i].kind == InteractionKind::kReflection
               ? reflect(wave, facets[i], wavelength)
               : transmit(wave, facets[i], wavelength);
  }
  path.arrival = wave.direction;
  path.a = received(receiver, wave, path.length, wavelength);
  return path;
}

}  // namespace rayloc
