// Soft visibility: how much of a wave a surface reflects or stops, as a smooth weight in [0, 1] of
// where the wave meets it. With hard visibility a channel jumps when a point of reflection slides
// off a face or a shadow passes over a path; with soft visibility it, and its derivatives by
// everything that moves, are continuous.
//
// One length says over what distance ("softness", [m]); physically about the radius of the first
// Fresnel zone, sqrt(lambda d1 d2 / (d1 + d2)). As it goes to 0 the weights become those of hard
// visibility.
//
// A weight is a product of smooth steps of
//   - the signed distance inside each edge of the surface, from -softness to softness. Of a surface
//     that is not convex: of the distance to its boundary;
//   - where it could vanish or appear otherwise, the distance along the path:
//     * a crossing that slides over the end of its segment. At an end on another mirror the
//     distance
//       counts by the sine of the angle between the planes: a crossing can only slide over an end
//       where planes intersect, and a thin object in front of a wall stops waves as it should. At a
//       device it counts near the edges only: to walk through the middle of a wall is no small
//       step.
//     * a segment between two mirrors, or between a mirror and a device near its edge, that shrinks
//       to a point: what lies beyond would come from behind the mirror.
//
// Written in a scalar T, so that with dual numbers weights carry derivatives.
#pragma once

#include <cmath>

#include "engine/base/vec3.h"
#include "engine/scene/surface.h"
#include "engine/trace/field_calculator.h"

namespace rayloc {

// 0 for x <= 0, 1 for x >= 1, with two continuous derivatives.
template <typename T>
T smooth_step(const T& x) {
  if (!(x > T(0))) {
    return T(0);
  }
  if (!(x < T(1))) {
    return T(1);
  }
  return x * x * x * (T(10) + x * (T(6) * x - T(15)));
}

// Smooth step of the distance of a point of the plane inside the edges, from `from` to `to` [m].
template <typename T>
T inside_weight(
    const Surface& surface, const Vec3<T>& shift, const Vec3<T>& point, double from, double to) {
  const auto constant = [](const Vec3d& v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
  const Vec3<T> from_origin = point - shift - constant(surface.origin());
  const T u = dot(constant(surface.u_axis()), from_origin);
  const T v = dot(constant(surface.v_axis()), from_origin);
  const auto step = [&](const T& inside) { return smooth_step((inside - T(from)) / T(to - from)); };
  if (!surface.is_convex()) {
    return step(surface.inside_distance(u, v));
  }
  T weight(1);
  for (const Surface::Edge& edge : surface.edges(surface.pieces().front())) {
    weight = weight * step(T(edge.a) * u + T(edge.b) * v + T(edge.c));
  }
  return weight;
}

template <typename T>
T edge_weight(const Surface& surface,
              const Facet<T>& facet,
              const Vec3<T>& point,
              double softness) {
  return inside_weight(surface, facet.shift, point, -softness, softness);
}

// One segment of a path and what its ends lie on; nullptr: a device.
template <typename T>
struct SoftSegment {
  Vec3<T> from;
  Vec3<T> to;
  const Vec3<T>* from_normal = nullptr;
  const Vec3<T>* to_normal = nullptr;
};

// How much the surface is in the way of the segment, which crosses its plane at `point`.
template <typename T>
T crossing_weight(const Surface& surface,
                  const Facet<T>& facet,
                  const SoftSegment<T>& segment,
                  const Vec3<T>& point,
                  double softness) {
  T weight = edge_weight(surface, facet, point, softness);
  const auto end = [&](const Vec3<T>& at, const Vec3<T>* normal) {
    const Vec3<T> along = point - at;
    const T away = dot(along, along);
    if (normal == nullptr) {
      const T near_edge = T(1) - inside_weight(surface, facet.shift, point, 0.0, softness);
      // near_edge = 0 in the middle of a surface: any distance will do.
      return T(1) - near_edge * (T(1) - smooth_step(away / T(softness * softness)));
    }
    const Vec3<T> across = cross(*normal, facet.plane.normal);
    const T scale = T(softness * softness) * dot(across, across);
    return scale > T(0) ? smooth_step(away / scale) : T(1);
  };
  weight = weight * end(segment.from, segment.from_normal);
  return weight * end(segment.to, segment.to_normal);
}

// What is left of a path by the length of a segment between two mirrors.
template <typename T>
T corner_weight(const Vec3<T>& from,
                const Vec3<T>& to,
                const Vec3<T>& from_normal,
                const Vec3<T>& to_normal,
                double softness) {
  const Vec3<T> across = cross(from_normal, to_normal);
  const T scale = T(softness * softness) * dot(across, across);
  const Vec3<T> along = to - from;
  return scale > T(0) ? smooth_step(dot(along, along) / scale) : T(1);
}

// What is left of a path by the length of the segment between a device and a mirror.
template <typename T>
T foot_weight(const Surface& surface,
              const Facet<T>& facet,
              const Vec3<T>& device,
              const Vec3<T>& point,
              double softness) {
  const T near_edge = T(1) - inside_weight(surface, facet.shift, point, 0.0, softness);
  const Vec3<T> along = point - device;
  return T(1) - near_edge * (T(1) - smooth_step(dot(along, along) / T(softness * softness)));
}

}  // namespace rayloc
