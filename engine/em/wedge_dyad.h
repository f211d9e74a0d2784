// Diffraction at the edge of a wedge that reflects and transmits: a heuristic on top of
// wedge_diffraction.h, for any polarisation and any angle to the edge.
//
// Each term of the uniform theory is multiplied by the jump of the geometrical wave at its
// boundary: R of the face in a term of reflection ([L]), 1 - P in the term of light, P being the
// straight path through both faces ([R]) or through the sheet ([B], in both terms of light). So the
// field is continuous wherever geometrical optics uses the same coefficients. The term of light
// that has no boundary uses R_0 R_n ([H]): then the field vanishes on the faces, as R = -1 at
// grazing incidence demands.
//
// The values of R and P away from the boundaries are a choice. The angle to a face is the lesser of
// those of source and observer and at most a right one, so that both may be exchanged, and grazing
// when either is in the face. [L] uses the source's at one face and the observer's at the other.
//
// A conductor (te = -1, excess = 0) gives soft() and hard() exactly.
//
// Limits: no exact solution of the dielectric wedge supports it. About a concrete bar it is right
// to 0.03 of the wave alone (engine/studies/2026-11-dielectric-wedge.md). Resonances within a body
// and creeping waves are missing. Where the source lights both faces, R_0 R_n is inaccurate ([E]).
// Hollow wedges (n < 1) reflect a wave more often than R includes here. For a solid that transmits,
// the cross terms of P jump where both azimuths are equal.
//
// References:
//   [L] R. J. Luebbers, IEEE Trans. Antennas Propag. 32 (1984) 70.
//   [H] P. D. Holm, IEEE Trans. Antennas Propag. 48 (2000) 1211.
//   [B] W. D. Burnside, K. W. Burgener, IEEE Trans. Antennas Propag. 31 (1983) 104.
//   [R] J.-F. Rouviere et al., IEEE Trans. Antennas Propag. 47 (1999) 1702.
//   [E] H. M. El-Sallabi, P. Vainikainen, IEEE Vehicular Technology Conference, spring 2003.
#pragma once

#include <cmath>
#include <numbers>

#include "engine/base/complex.h"
#include "engine/em/slab_table.h"
#include "engine/em/wedge_diffraction.h"

namespace rayloc {

// For a path with the unit direction d at an edge along e: the part along e - (e . d) d (soft), and
// the part along d x e (hard). The first letter is the outgoing part, the second the incoming one.
template <typename T>
struct WedgeDyad {
  Complex<T> ss, sh, hs, hh;

  friend WedgeDyad operator*(const WedgeDyad& a, const WedgeDyad& b) {
    return {a.ss * b.ss + a.sh * b.hs,
            a.ss * b.sh + a.sh * b.hh,
            a.hs * b.ss + a.hh * b.hs,
            a.hs * b.sh + a.hh * b.hh};
  }
  friend WedgeDyad operator*(const Complex<T>& s, const WedgeDyad& a) {
    return {s * a.ss, s * a.sh, s * a.hs, s * a.hh};
  }
  friend WedgeDyad operator+(const WedgeDyad& a, const WedgeDyad& b) {
    return {a.ss + b.ss, a.sh + b.sh, a.hs + b.hs, a.hh + b.hh};
  }
};

// The body at the edge. A Face has reflection(cos) and transmission(cos) of the angle of incidence,
// which return a SlabTable::Pair<T>.
enum class WedgeBody {
  kOpaque,  // no transmission
  kSolid,   // transmission through both faces
  kSheet,   // through one face, for n = 2 with both sides
};

namespace wedge {

// Geometry of both ends, symmetric under their exchange.
template <typename T>
struct Ends {
  double n = 2.0;
  T low{}, high{};  // [rad], the smaller and the larger azimuth
  T half_apart{};   // [rad], half of to - from
  T half_sum{};     // [rad]
  T sin_edge{};     // of the angle between the path and the edge
  T cos_edge{};
};

// The lesser angle to a face, at most a right one [rad].
template <typename T>
T lesser_angle(const T& a, const T& b) {
  const T right(std::numbers::pi / 2.0);
  const T& least = a < b ? a : b;
  return least < right ? (least < T(0) ? T(0) : least) : right;
}

// `angle`: to the face across the edge; the field by reflection.h in the edge's own directions.
template <typename T, typename Face>
WedgeDyad<T> reflection(const Face& face, const T& angle, const Ends<T>& ends) {
  using std::cos;
  using std::sin;
  const T up = sin(angle);
  const T along = cos(angle);
  const SlabTable::Pair<T> r = face.reflection(T(up * ends.sin_edge));
  const T steep = ends.cos_edge * up;
  const Complex<T> cross = Complex<T>{steep * sin(ends.half_apart), T(0)} * r.excess;
  return {r.te - Complex<T>{steep * steep, T(0)} * r.excess,
          Complex<T>{} - cross,
          cross,
          Complex<T>{along * along, T(0)} * r.excess - r.te};
}

// `along`: component of the path in the face, across the edge, relative to it.
template <typename T, typename Face>
WedgeDyad<T> transmission(const Face& face, const T& angle, const T& along, const Ends<T>& ends) {
  using std::cos;
  using std::sin;
  const T up = sin(angle);
  const T level = cos(angle);
  const SlabTable::Pair<T> t = face.transmission(T(up * ends.sin_edge));
  const T steep = ends.cos_edge * up;
  const Complex<T> cross = Complex<T>{steep * along, T(0)} * t.excess;
  return {t.te + Complex<T>{steep * steep, T(0)} * t.excess,
          cross,
          cross,
          t.te + Complex<T>{level * level, T(0)} * t.excess};
}

// Transmission of the straight path past the edge, on the wedge's side of it.
template <typename T, typename Face>
WedgeDyad<T> passed(
    const Face& face_0, const Face& face_n, WedgeBody body, bool rising, const Ends<T>& ends) {
  using std::sin;
  if (body == WedgeBody::kOpaque) {
    return {};
  }
  const T inside((2.0 - ends.n) * std::numbers::pi);
  const T n_pi(ends.n * std::numbers::pi);
  const T two_pi(2.0 * std::numbers::pi);
  WedgeDyad<T> at_0 = transmission(
      face_0, lesser_angle<T>(ends.low, two_pi - ends.high), T(sin(ends.half_sum)), ends);
  if (body == WedgeBody::kSheet) {
    return at_0;
  }
  const WedgeDyad<T> at_n = transmission(face_n,
                                         lesser_angle<T>(n_pi - ends.high, ends.low + inside),
                                         T(sin(ends.half_sum - n_pi)),
                                         ends);
  return rising ? at_n * at_0 : at_0 * at_n;
}

}  // namespace wedge

namespace wedge {

// Factors of the terms of the uniform theory.
template <typename T>
struct Jumps {
  WedgeDyad<T> stopped;  // for the term of light that may have a boundary
  WedgeDyad<T> twice;    // for the other one
  WedgeDyad<T> r_0, r_n;
};

template <typename T, typename Face>
Jumps<T> jumps(const WedgeRay<T>& ray,
               const T& cos_edge,
               const Face& face_0,
               const Face& face_n,
               WedgeBody body) {
  using std::sqrt;
  const bool rising = ray.from < ray.to;
  const T& low = rising ? ray.from : ray.to;
  const T& high = rising ? ray.to : ray.from;
  const Ends<T> ends{ray.n,
                     low,
                     high,
                     (ray.to - ray.from) / T(2),
                     (ray.to + ray.from) / T(2),
                     sqrt(T(1) - cos_edge * cos_edge),
                     cos_edge};
  const T to_n = T(ray.n * std::numbers::pi) - high;
  const bool is_sheet = body == WedgeBody::kSheet;
  // A sheet has one face, whose sides are alike.
  const WedgeDyad<T> r_0 = reflection(face_0, lesser_angle<T>(low, is_sheet ? to_n : low), ends);
  const WedgeDyad<T> r_n = is_sheet ? r_0 : reflection(face_n, lesser_angle<T>(to_n, to_n), ends);
  const Complex<T> one{T(1), T(0)};
  const WedgeDyad<T> whole{one, {}, {}, one};
  const WedgeDyad<T> stopped =
      whole + Complex<T>{T(-1), T(0)} * passed(face_0, face_n, body, rising, ends);
  const WedgeDyad<T> rotated_twice = rising ? r_n * r_0 : r_0 * r_n;
  return {stopped, is_sheet ? stopped : rotated_twice, r_0, r_n};
}

// The terms of the uniform theory by the boundaries at which they restore continuity, each with its
// slope by its angle: - and + the distance between the azimuths, - and + their sum.
template <typename T>
struct Terms {
  ValueAndSlope<Complex<T>> stopped, twice, r_0, r_n;
};

template <typename T>
Terms<T> terms(const WedgeRay<T>& ray) {
  const T apart = ray.from < ray.to ? ray.to - ray.from : ray.from - ray.to;
  const T sum = ray.to + ray.from;
  const auto at = [&](const T& b) { return term<T>(ray.n, b, ray.phase_length); };
  return {at(-apart), at(apart), at(-sum), at(sum)};
}

template <typename T>
WedgeDyad<T> sum_of(const Terms<T>& terms, const Jumps<T>& jumps) {
  return terms.stopped.value * jumps.stopped + terms.twice.value * jumps.twice +
         terms.r_0.value * jumps.r_0 + terms.r_n.value * jumps.r_n;
}

}  // namespace wedge

// The diffracted wave relative to one of the same length (wedge_diffraction.h). `cos_edge`:
// the path's direction along the edge; the edge e is the axis about which azimuths grow.
// REQUIRES: |cos_edge| < 1.
template <typename T, typename Face>
WedgeDyad<T> wedge_dyad(const WedgeRay<T>& ray,
                        const T& cos_edge,
                        const Face& face_0,
                        const Face& face_n,
                        WedgeBody body) {
  return wedge::sum_of(wedge::terms(ray), wedge::jumps(ray, cos_edge, face_0, face_n, body));
}

// The same, and its derivatives by each azimuth, for waves with a slope across the edge
// (wedge_slope_terms()). The reflection and transmission of faces are taken as constant: on a face
// they are, and in other directions the slope of the terms is the larger part.
template <typename T>
struct SlopedWedgeDyad {
  WedgeDyad<T> value;
  WedgeDyad<T> by_from;
  WedgeDyad<T> by_to;
};

template <typename T, typename Face>
SlopedWedgeDyad<T> sloped_wedge_dyad(const WedgeRay<T>& ray,
                                     const T& cos_edge,
                                     const Face& face_0,
                                     const Face& face_n,
                                     WedgeBody body) {
  const wedge::Terms<T> terms = wedge::terms(ray);
  const wedge::Jumps<T> jumps = wedge::jumps(ray, cos_edge, face_0, face_n, body);
  const Complex<T> minus{T(-1), T(0)};
  const WedgeDyad<T> by_apart =
      minus * (terms.stopped.slope * jumps.stopped) + terms.twice.slope * jumps.twice;
  const WedgeDyad<T> by_sum = minus * (terms.r_0.slope * jumps.r_0) + terms.r_n.slope * jumps.r_n;
  const WedgeDyad<T> value = wedge::sum_of(terms, jumps);
  const WedgeDyad<T> against = minus * by_apart + by_sum;
  const WedgeDyad<T> with = by_apart + by_sum;
  return ray.from < ray.to ? SlopedWedgeDyad<T>{value, against, with}
                           : SlopedWedgeDyad<T>{value, with, against};
}

}  // namespace rayloc
