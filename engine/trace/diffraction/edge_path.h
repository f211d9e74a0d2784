// A path over one edge: its bend, and the field along it.
//
// Reflections before the edge make an image of the transmitter, those after it one of the receiver.
// Between both images the path is the shortest one over the edge's line (Fermat): exact, and
// without a search. Faces that the wave crosses change neither.
//
// Written in a scalar T, so that with dual numbers the coefficient carries derivatives by both
// ends, the planes, the edge, the materials and the orientations. edge_finder.h tests that the
// points lie on the edge and on the mirrors and that the path is not obstructed.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <utility>

#include "engine/base/complex.h"
#include "engine/base/vec3.h"
#include "engine/em/wedge_dyad.h"
#include "engine/scene/wedges.h"
#include "engine/trace/field_calculator.h"
#include "engine/trace/image_method.h"
#include "engine/trace/interactions/interaction.h"
#include "engine/trace/path.h"

namespace rayloc {

// The line of a Wedge, which with dual numbers may move.
template <typename T>
struct EdgeLine {
  Vec3<T> from;     // [m], world
  Vec3<T> along;    // unit
  Vec3<T> in_face;  // unit, across `along`: azimuth 0
  double n = 2.0;   // exterior angle over pi
};

template <typename T>
EdgeLine<T> edge_line(const Wedge& wedge) {
  const auto constant = [](const Vec3d& v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
  return {constant(wedge.from), constant(wedge.along), constant(wedge.in_face), wedge.n};
}

// A point relative to an edge: the data that determine the bend of a path over the edge.
template <typename T>
struct OffEdge {
  T height{};  // [m], along the edge from EdgeLine::from
  T radius{};  // [m]
};
template <typename T>
struct AboutEdge : OffEdge<T> {
  T azimuth{};  // [rad], in [0, 2 pi)
};

// REQUIRES: the point is not on the line.
template <typename T>
AboutEdge<T> about_edge(const EdgeLine<T>& edge, const Vec3<T>& point) {
  using std::atan2;
  using std::sqrt;
  const Vec3<T> off = point - edge.from;
  const T x = dot(off, edge.in_face);
  const T y = dot(off, cross(edge.along, edge.in_face));
  T azimuth = atan2(y, x);
  if (azimuth < T(0)) {
    azimuth = azimuth + T(2.0 * std::numbers::pi);
  }
  return {{dot(off, edge.along), sqrt(x * x + y * y)}, azimuth};
}

// Height at which the shortest path from one point over the edge to another bends [m]: there both
// legs make the same angle with it (Fermat, Keller).
template <typename T>
T edge_height(const OffEdge<T>& from, const OffEdge<T>& to) {
  return (from.height * to.radius + to.height * from.radius) / (from.radius + to.radius);
}

// A face in the form that wedge_dyad.h requires.
template <typename T>
struct WedgeFace {
  Facet<T> facet;
  T wavelength{};  // [m]

  SlabTable::Pair<T> reflection(const T& cosine) const {
    return interactions::Reflection::coefficients(cosine, facet, wavelength);
  }
  SlabTable::Pair<T> transmission(const T& cosine) const {
    return interactions::Transmission::coefficients(cosine, facet, wavelength);
  }
};

// The line of a wedge whose faces have moved: where their planes meet; of a sheet it moves with it.
template <typename T>
EdgeLine<T> edge_line(const Wedge& wedge, const Facet<T>& face_0, const Facet<T>& face_n) {
  // Almost coplanar faces have no intersection: the sine between them, chosen.
  constexpr double kParallel = 1e-3;
  EdgeLine<T> line = edge_line<T>(wedge);
  const double cosine = std::cos(wedge.n * std::numbers::pi);
  const double sine = std::sin(wedge.n * std::numbers::pi);
  if (std::abs(sine) < kParallel) {
    line.from = line.from + face_0.shift;
    return line;
  }
  const auto constant = [](const Vec3d& v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
  const T up = dot(face_0.shift, constant(wedge.normal));
  const T off = dot(face_n.shift, constant(cosine * wedge.normal - sine * wedge.in_face));
  line.from = line.from + up * constant(wedge.normal) +
              ((T(cosine) * up - off) / T(sine)) * constant(wedge.in_face);
  return line;
}

// The wave behind the edge that continues in the direction `out`.
template <typename T>
Wave<T> diffracted(const Wave<T>& in,
                   const Vec3<T>& along,
                   const Vec3<T>& out,
                   const WedgeDyad<T>& dyad) {
  const auto unit = [](const Vec3<T>& v) { return (T(1) / norm(v)) * v; };
  const auto soft = [&](const Vec3<T>& d) { return unit(along - dot(along, d) * d); };
  const auto hard = [&](const Vec3<T>& d) { return unit(cross(d, along)); };
  const auto part = [&](const Vec3<T>& direction) {
    return Complex<T>{dot(in.field.re, direction), dot(in.field.im, direction)};
  };
  const Complex<T> s = part(soft(in.direction));
  const Complex<T> h = part(hard(in.direction));
  const Complex<T> s_out = dyad.ss * s + dyad.sh * h;
  const Complex<T> h_out = dyad.hs * s + dyad.hh * h;
  const Vec3<T> to_soft = soft(out);
  const Vec3<T> to_hard = hard(out);
  return {{s_out.re * to_soft + h_out.re * to_hard, s_out.im * to_soft + h_out.im * to_hard}, out};
}

// A wedge at which a path bends, unmodified.
struct MetWedge {
  const Wedge& wedge;
  WedgeBody body;
};

// An edge at which a path bends. The facet at its place is the wedge's face 0.
template <typename T>
struct EdgeOfPath {
  MetWedge met;
  Facet<T> face_n;
  std::size_t place = 0;  // among the path's interactions
};

// The transmitter, seen through the mirrors before the interaction at `end`.
template <typename T>
Vec3<T> image_before(std::span<const Interaction> interactions,
                     std::span<const Facet<T>> facets,
                     std::size_t end,
                     Vec3<T> source) {
  for (std::size_t i = 0; i < end; ++i) {
    source = is_mirror(interactions[i].kind) ? mirror(facets[i].plane, source) : source;
  }
  return source;
}

// The receiver, seen through the mirrors behind the interaction at `begin`.
template <typename T>
Vec3<T> image_behind(std::span<const Interaction> interactions,
                     std::span<const Facet<T>> facets,
                     std::size_t begin,
                     Vec3<T> observer) {
  for (std::size_t i = facets.size() - 1; i > begin; --i) {
    observer = is_mirror(interactions[i].kind) ? mirror(facets[i].plane, observer) : observer;
  }
  return observer;
}

// Direction of departure of the wave that reaches the interaction at `end` in direction `in`.
template <typename T>
Vec3<T> departure_of(std::span<const Interaction> interactions,
                     std::span<const Facet<T>> facets,
                     std::size_t end,
                     Vec3<T> in) {
  for (std::size_t i = end; i > 0; --i) {
    if (is_mirror(interactions[i - 1].kind)) {
      in = interactions::Reflection::mirrored(in, facets[i - 1].plane.normal);
    }
  }
  return in;
}

// The wave behind the interactions from `begin` on, before that at `end`.
template <typename T>
Wave<T> carried(Wave<T> wave,
                std::span<const Interaction> interactions,
                std::span<const Facet<T>> facets,
                const std::pair<std::size_t, std::size_t>& from_to,
                const T& wavelength) {
  for (std::size_t i = from_to.first; i < from_to.second; ++i) {
    wave = visit_interaction(interactions[i].kind, [&](auto kind) {
      return decltype(kind)::apply(wave, facets[i], wavelength);
    });
  }
  return wave;
}

// The path over `facets`, with the kinds of `interactions`. REQUIRES: the images of both ends are
// off the edge's line and outside of the wedge.
template <typename T>
PathCoefficient<T> edge_path(const EdgeOfPath<T>& at,
                             std::span<const Interaction> interactions,
                             std::span<const Facet<T>> facets,
                             const std::pair<const LinkEnd<T>&, const LinkEnd<T>&>& ends,
                             const T& wavelength) {
  const auto& [transmitter, receiver] = ends;
  const Vec3<T> source = image_before<T>(interactions, facets, at.place, transmitter.position);
  const Vec3<T> observer = image_behind<T>(interactions, facets, at.place, receiver.position);
  const EdgeLine<T> edge = edge_line<T>(at.met.wedge, facets[at.place], at.face_n);
  const AboutEdge<T> from = about_edge(edge, source);
  const AboutEdge<T> to = about_edge(edge, observer);
  const Vec3<T> bend = edge.from + edge_height(from, to) * edge.along;
  const Vec3<T> there = bend - source;
  const Vec3<T> onwards = observer - bend;
  const T first = norm(there);
  const T second = norm(onwards);
  const Vec3<T> in = (T(1) / first) * there;
  PathCoefficient<T> path;
  path.length = first + second;
  path.departure = departure_of<T>(interactions, facets, at.place, in);
  // k s' s sin^2 / (s' + s), with the radii in place of s' sin and s sin.
  const T wave_number = T(2.0 * std::numbers::pi) / wavelength;
  const WedgeRay<T> ray{
      edge.n, from.azimuth, to.azimuth, wave_number * from.radius * to.radius / path.length};
  const WedgeDyad<T> dyad = wedge_dyad<T>(ray,
                                          dot(in, edge.along),
                                          WedgeFace<T>{facets[at.place], wavelength},
                                          WedgeFace<T>{at.face_n, wavelength},
                                          at.met.body);
  Wave<T> wave = carried<T>(
      radiated(transmitter, path.departure), interactions, facets, {0, at.place}, wavelength);
  wave = diffracted(wave, edge.along, (T(1) / second) * onwards, dyad);
  wave = carried<T>(wave, interactions, facets, {at.place + 1, facets.size()}, wavelength);
  path.arrival = wave.direction;
  path.a = received(receiver, wave, path.length, wavelength);
  return path;
}

}  // namespace rayloc
