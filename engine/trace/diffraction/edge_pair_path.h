// A path over two edges in a row: the field along it.
//
// Each edge diffracts a wave as in wedge_dyad.h, from a source or towards an observer that is the
// other edge. The spreading is that of stationary phase over both edges: the lengths of the parts
// and the second derivatives of the length by both bends (for parallel edges it is that of [KP]).
// Along a face that both edges share a wave vanishes, or its slope does. So the field diffracted by
// the first edge is used with its slope across the path ([A], wedge_diffraction.h), and both with
// factor one half: the incident wave and the one that the face reflects are one.
//
// Limits: where both edges are near to a boundary of shadow or reflection of each other at once
// (ends and edges in about one plane), one transition of two variables ([AB]) is replaced by two
// of one. Where the path between them is shorter than a wavelength, multiple diffraction between
// them is left out.
//
// References:
//   [KP] R. G. Kouyoumjian, P. H. Pathak, Proc. IEEE 62 (1974) 1448.
//   [A]  J. B. Andersen, IEEE Trans. Antennas Propag. 45 (1997) 1093.
//   [N]  K. A. Norton, Proc. IRE 24 (1936) 1367.
//   [AB] M. Albani, IEEE Trans. Antennas Propag. 53 (2005) 702.
#pragma once

#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "engine/base/complex.h"
#include "engine/base/dual.h"
#include "engine/em/slab_table.h"
#include "engine/em/wedge_dyad.h"
#include "engine/em/wedge_transition.h"
#include "engine/trace/diffraction/edge_pair.h"
#include "engine/trace/diffraction/edge_path.h"

namespace rayloc {

// A face along which a wave travels from one edge to the other. At grazing incidence any face
// except a conductor reflects a wave to zero field; over a short path not completely. A magnetic
// field along the edges becomes F = 1 - w G(w) of its value on a conductor, w = sqrt(k d / 2) |Z|
// ([N], with the face's surface impedance Z over that of free space and G of wedge_transition.h).
// Each edge has the square root of it.
template <typename T>
struct FaceAlong {
  WedgeFace<T> face;
  bool is_along = false;
  T half_phase{};  // k d / 2 [rad]

  SlabTable::Pair<T> reflection(const T& cosine) const {
    constexpr double kGrazing = 1e-9;  // a cosine, chosen: beyond rounding
    return is_along && value_of(cosine) < kGrazing ? grazing() : face.reflection(cosine);
  }
  SlabTable::Pair<T> transmission(const T& cosine) const { return face.transmission(cosine); }

 private:
  SlabTable::Pair<T> grazing() const {
    using std::sqrt;
    // The impedance follows from R = (c - Z) / (c + Z) at a small cosine c, chosen.
    constexpr double kSmall = 0.01;
    constexpr double kTiny = 1e-24;  // chosen: keeps the slope of a root finite at 0
    const auto size = [&](const Complex<T>& z) {
      return sqrt(z.re * z.re + z.im * z.im + T(kTiny));
    };
    const SlabTable::Pair<T> small = face.reflection(T(kSmall));
    const Complex<T> one{T(1), T(0)};
    const Complex<T> tm = Complex<T>{T(1.0 - kSmall * kSmall), T(0)} * small.excess - small.te;
    const T w = sqrt(half_phase) * T(kSmall) * size(one - tm) / size(one + tm);
    const Complex<T> left = Complex<T>{} - wedge_transition(w).excess;
    const Complex<T> root = sqrt(left);
    const Complex<T> te{T(-1), T(0)};
    return {te, te + root + root - one};
  }
};

// Geometry of a path over two edges.
template <typename T>
struct EdgePairRays {
  std::pair<EdgeLine<T>, EdgeLine<T>> edges;
  EdgePairRoute<T> route;
  std::optional<SharedSide> side;     // followed by the part between
  T sin_first{}, sin_second{};        // of the angles between edges and path
  T length_first{}, length_second{};  // [m], L of each edge
  WedgeRay<T> ray_first, ray_second;
};

// `ends`: source and observer, images through the mirrors before and behind the edges.
template <typename T>
EdgePairRays<T> edge_pair_rays(const std::pair<EdgeOfPath<T>, EdgeOfPath<T>>& at,
                               std::span<const Interaction> interactions,
                               std::span<const Facet<T>> facets,
                               const std::pair<Vec3<T>, Vec3<T>>& ends,
                               const T& wave_number) {
  using std::sqrt;
  const auto& [source, observer] = ends;
  const auto line = [&](const EdgeOfPath<T>& edge) {
    return edge_line<T>(edge.met.wedge, facets[edge.place], edge.face_n);
  };
  const auto height = [&](const EdgeOfPath<T>& edge) {
    const Wedge& wedge = edge.met.wedge;
    return T(dot(interactions[edge.place].position - wedge.from, wedge.along));
  };
  EdgePairRays<T> rays;
  rays.edges = {line(at.first), line(at.second)};
  const auto& [first, second] = rays.edges;
  const EdgePairBends<T> bends =
      improved<T>(rays.edges, source, observer, {height(at.first), height(at.second)});
  rays.route = edge_pair_route(rays.edges, source, observer, bends);
  const EdgePairRoute<T>& route = rays.route;
  const auto sine = [](const T& cosine) { return sqrt(T(1) - cosine * cosine); };
  rays.sin_first = sine(dot(first.along, route.across));
  rays.sin_second = sine(dot(second.along, route.across));
  const auto together = [](const T& a, const T& b, const T& s) { return a * b / (a + b) * s * s; };
  rays.length_first = together(route.before, route.between, rays.sin_first);
  rays.length_second = together(route.between, route.behind, rays.sin_second);
  rays.ray_first = {first.n,
                    about_edge(first, source).azimuth,
                    about_edge(first, second.from + bends.second * second.along).azimuth,
                    wave_number * rays.length_first};
  rays.ray_second = {second.n,
                     about_edge(second, first.from + bends.first * first.along).azimuth,
                     about_edge(second, observer).azimuth,
                     wave_number * rays.length_second};
  rays.side = shared_side({at.first.met.wedge, at.second.met.wedge},
                          interactions[at.first.place].along_face_n);
  if (rays.side) {
    rays.ray_first.to = T(rays.side->at_first);
    rays.ray_second.from = T(rays.side->at_second);
  }
  return rays;
}

// The path over `facets`, with the kinds of `interactions`. REQUIRES: as
// edge_path(); nothing reflects between the edges; the interactions are located at
// the bends of the path.
template <typename T>
PathCoefficient<T> edge_pair_path(const std::pair<EdgeOfPath<T>, EdgeOfPath<T>>& at,
                                  std::span<const Interaction> interactions,
                                  std::span<const Facet<T>> facets,
                                  const std::pair<const LinkEnd<T>&, const LinkEnd<T>&>& ends,
                                  const T& wavelength) {
  using std::sqrt;
  const EdgeOfPath<T>& one = at.first;  // not bindings: clang 14 cannot capture them in a lambda
  const EdgeOfPath<T>& two = at.second;
  const T wave_number = T(2.0 * std::numbers::pi) / wavelength;
  const EdgePairRays<T> rays =
      edge_pair_rays<T>(at,
                        interactions,
                        facets,
                        {image_before<T>(interactions, facets, one.place, ends.first.position),
                         image_behind<T>(interactions, facets, two.place, ends.second.position)},
                        wave_number);
  const EdgePairRoute<T>& route = rays.route;
  const Vec3<T>& along_1 = rays.edges.first.along;
  const Vec3<T>& along_2 = rays.edges.second.along;
  const auto of = [&](const EdgeOfPath<T>& edge, const WedgeRay<T>& ray, const T& cosine) {
    const T half_phase = wave_number * route.between / T(2);
    const auto along = [&](const Facet<T>& face) {
      return FaceAlong<T>{{face, wavelength}, rays.side.has_value(), half_phase};
    };
    return sloped_wedge_dyad<T>(
        ray, cosine, along(facets[edge.place]), along(edge.face_n), edge.met.body);
  };
  const auto first = of(one, rays.ray_first, dot(route.in, along_1));
  const auto second = of(two, rays.ray_second, dot(route.across, along_2));
  PathCoefficient<T> path;
  path.length = route.before + route.between + route.behind;
  path.departure = departure_of<T>(interactions, facets, one.place, route.in);
  const Wave<T> lit = carried<T>(
      radiated(ends.first, path.departure), interactions, facets, {0, one.place}, wavelength);
  const auto over = [&](const WedgeDyad<T>& at_first, const WedgeDyad<T>& at_second) {
    Wave<T> wave = diffracted(lit, along_1, route.across, at_first);
    wave = carried<T>(wave, interactions, facets, {one.place + 1, two.place}, wavelength);
    wave = diffracted(wave, along_2, route.out, at_second);
    return carried<T>(wave, interactions, facets, {two.place + 1, facets.size()}, wavelength);
  };
  // Per metre across the path at the second edge, towards larger azimuths of its source, over k.
  const T slope = dot(cross(along_1, route.across), cross(route.across, along_2)) /
                  (rays.sin_first * rays.sin_first * rays.sin_second * rays.sin_second *
                   route.between * wave_number);
  const Wave<T> level = over(first.value, second.value);
  const Wave<T> sloped = over(first.by_to, Complex<T>{T(0), -slope} * second.by_from);
  const T spread = T(rays.side ? 0.5 : 1.0) * path.length *
                   sqrt(rays.length_first * rays.length_second /
                        edge_pair_curvature(rays.edges, route).determinant()) /
                   (route.before * route.between * route.behind);
  const Wave<T> wave{
      {spread * (level.field.re + sloped.field.re), spread * (level.field.im + sloped.field.im)},
      level.direction};
  path.arrival = wave.direction;
  path.a = received(ends.second, wave, path.length, wavelength);
  return path;
}

}  // namespace rayloc
