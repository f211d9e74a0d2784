// Soft visibility: how much of a wave a surface reflects or blocks, as a smooth weight in [0, 1] of
// the point where the wave meets it. With hard visibility a channel jumps when a point of
// reflection slides off a face or a shadow passes over a path; with soft visibility the channel and
// its derivatives by everything that moves are continuous.
//
// The transition takes place over one length ("softness", [m]); physically about the radius of the
// first Fresnel zone, sqrt(lambda d1 d2 / (d1 + d2)). As it goes to 0 the weights become those of
// hard visibility.
//
// A weight is a product of smooth steps. The first is of the signed distance inside each edge of
// the surface, from -softness to softness (of a surface that is not convex: inside its boundary).
// The others apply where a path or a shadow could appear or vanish otherwise:
//
// A crossing slides over the end of its segment: the distance of that end from the plane. At an
// end on another mirror the softness is scaled by the sine of the angle between the planes, since
// crossings slide over ends where planes intersect, and a picture on a wall shall stop waves; but
// by 1/50 at least, since they also come and go when parallel faces touch (an object on the
// floor). At a device it counts near edges only: moving a device through the middle of a wall is
// no small step.
//
// A segment between two mirrors, or between a mirror and a device near its edge, shrinks to a
// point: its length. A path beyond that would come from behind the mirror.
//
// Written in a scalar T, so that with dual numbers weights carry derivatives.
#pragma once

#include <cmath>

#include "engine/base/smooth_step.h"
#include "engine/base/vec3.h"
#include "engine/scene/surface.h"
#include "engine/trace/field_calculator.h"

namespace rayloc {

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

// One segment of a path and the surfaces at its ends; nullptr: a device.
template <typename T>
struct SoftSegment {
  Vec3<T> from;
  Vec3<T> to;
  const Vec3<T>* from_normal = nullptr;
  const Vec3<T>* to_normal = nullptr;
};

// Squared softness that applies to the distance of a point of one plane from the other.
template <typename T>
T slant_softness2(const Vec3<T>& normal, const Vec3<T>& other, double softness) {
  // The sine between planes, chosen: 1.1 degrees count as parallel.
  constexpr double kMinSlant = 0.02;
  const T least(kMinSlant * kMinSlant);
  const Vec3<T> across = cross(normal, other);
  const T slant2 = dot(across, across);
  return T(softness * softness) * (slant2 > least ? slant2 : least);
}

// Blocking weight of the surface for the segment, which crosses its plane at `point`.
template <typename T>
T crossing_weight(const Surface& surface,
                  const Facet<T>& facet,
                  const SoftSegment<T>& segment,
                  const Vec3<T>& point,
                  double softness) {
  T weight = edge_weight(surface, facet, point, softness);
  const auto end = [&](const Vec3<T>& at, const Vec3<T>* normal) {
    const T behind = distance(facet.plane, at);
    const T away = behind * behind;
    if (normal == nullptr) {
      const T near_edge = T(1) - inside_weight(surface, facet.shift, point, 0.0, softness);
      // near_edge = 0 in the middle of a surface: any distance is accepted.
      return T(1) - near_edge * (T(1) - smooth_step(away / T(softness * softness)));
    }
    return smooth_step(T(away / slant_softness2(*normal, facet.plane.normal, softness)));
  };
  weight = weight * end(segment.from, segment.from_normal);
  return weight * end(segment.to, segment.to_normal);
}

// Weight of a path from the length of a segment between two mirrors.
template <typename T>
T corner_weight(const Vec3<T>& from,
                const Vec3<T>& to,
                const Vec3<T>& from_normal,
                const Vec3<T>& to_normal,
                double softness) {
  const Vec3<T> along = to - from;
  return smooth_step(T(dot(along, along) / slant_softness2(from_normal, to_normal, softness)));
}

// Weight of a path from the length of the segment between a device and a mirror.
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
