// Two edges in a row: the bends of a path over both, and the face that both may share.
#pragma once

#include <optional>
#include <utility>

#include "engine/base/vec3.h"
#include "engine/scene/wedges.h"
#include "engine/trace/diffraction/edge_path.h"

namespace rayloc {

// Heights of the bends on two lines [m].
template <typename T>
struct EdgePairBends {
  T first{}, second{};
};

// The three parts of a path over two lines.
template <typename T>
struct EdgePairRoute {
  T before{}, between{}, behind{};  // [m]
  Vec3<T> in, across, out;          // their directions, unit
};

template <typename T>
EdgePairRoute<T> edge_pair_route(const std::pair<EdgeLine<T>, EdgeLine<T>>& edges,
                                 const Vec3<T>& source,
                                 const Vec3<T>& observer,
                                 const EdgePairBends<T>& bends) {
  const Vec3<T> at_first = edges.first.from + bends.first * edges.first.along;
  const Vec3<T> at_second = edges.second.from + bends.second * edges.second.along;
  EdgePairRoute<T> route;
  const auto part = [](const Vec3<T>& off, T& length, Vec3<T>& direction) {
    length = norm(off);
    direction = (T(1) / length) * off;
  };
  part(at_first - source, route.before, route.in);
  part(at_second - at_first, route.between, route.across);
  part(observer - at_second, route.behind, route.out);
  return route;
}

// Second derivatives of the length by the heights of both bends [1/m]. Their determinant is
// positive unless the path is along an edge.
template <typename T>
struct EdgePairCurvature {
  T first{}, mixed{}, second{};
  T determinant() const { return first * second - mixed * mixed; }
};

template <typename T>
EdgePairCurvature<T> edge_pair_curvature(const std::pair<EdgeLine<T>, EdgeLine<T>>& edges,
                                         const EdgePairRoute<T>& route) {
  const Vec3<T>& e = edges.first.along;
  const Vec3<T>& f = edges.second.along;
  const auto across = [](const T& cosine) { return T(1) - cosine * cosine; };
  const T e_across = dot(e, route.across);
  const T f_across = dot(f, route.across);
  return {across(dot(e, route.in)) / route.before + across(e_across) / route.between,
          (e_across * f_across - dot(e, f)) / route.between,
          across(f_across) / route.between + across(dot(f, route.out)) / route.behind};
}

// One Newton step towards the shortest path. From bends with correct values it gives their
// first derivatives.
template <typename T>
EdgePairBends<T> improved(const std::pair<EdgeLine<T>, EdgeLine<T>>& edges,
                          const Vec3<T>& source,
                          const Vec3<T>& observer,
                          const EdgePairBends<T>& bends) {
  const EdgePairRoute<T> route = edge_pair_route(edges, source, observer, bends);
  const EdgePairCurvature<T> curved = edge_pair_curvature(edges, route);
  const T by_first = dot(edges.first.along, route.in - route.across);
  const T by_second = dot(edges.second.along, route.across - route.out);
  const T determinant = curved.determinant();
  return {bends.first - (curved.second * by_first - curved.mixed * by_second) / determinant,
          bends.second - (curved.first * by_second - curved.mixed * by_first) / determinant};
}

// The shortest path over both lines: the length is convex, so there is one. Nothing where it cannot
// be determined: it comes too near to an end or to the intersection of the lines.
std::optional<EdgePairBends<double>> shortest_over(
    const std::pair<EdgeLine<double>, EdgeLine<double>>& edges,
    const Vec3d& source,
    const Vec3d& observer);

// A side of a face that two edges share: the path between them follows it. Its azimuths [rad].
struct SharedSide {
  double at_first = 0.0;
  double at_second = 0.0;
};

// The side along face 0 or face n of the first; nothing: the second one does not share that side.
// Free edges of one sheet share both.
std::optional<SharedSide> shared_side(const std::pair<const Wedge&, const Wedge&>& edges,
                                      bool along_face_n);

}  // namespace rayloc
