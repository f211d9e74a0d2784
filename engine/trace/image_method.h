// The image method: exact vertices of a chain of specular reflections, from plane equations.
//
// Written in a scalar T, so that with dual numbers the vertices carry derivatives by either end and
// by every plane. This file has no branches: image_tree.h tests that the vertices lie on the
// surfaces and that the path is not blocked.
#pragma once

#include <cstddef>
#include <span>

#include "engine/base/check.h"
#include "engine/base/vec3.h"
#include "engine/scene/surface.h"

namespace rayloc {

// Mirror image of a point.
template <typename T>
Vec3<T> mirror(const Plane<T>& plane, const Vec3<T>& point) {
  return point - (T(2) * distance(plane, point)) * plane.normal;
}

// Intersection of line `point` - `image` with the plane. REQUIRES: they are on different sides.
template <typename T>
Vec3<T> meet(const Plane<T>& plane, const Vec3<T>& point, const Vec3<T>& image) {
  const T here = distance(plane, point);
  const T there = distance(plane, image);
  return point + (here / (here - there)) * (image - point);
}

// The path from `source` over `planes` in that order to `target`: vertices[0] is the source,
// vertices[i] the reflection at planes[i - 1], the last one the target.
// REQUIRES: vertices.size() == planes.size() + 2.
template <typename T>
void reflection_vertices(const Vec3<T>& source,
                         std::span<const Plane<T>> planes,
                         const Vec3<T>& target,
                         std::span<Vec3<T>> vertices) {
  RAYLOC_CHECK(vertices.size() == planes.size() + 2);
  // Forwards the images of the source, backwards the intersections of the lines to them.
  vertices[0] = source;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    vertices[i + 1] = mirror(planes[i], vertices[i]);
  }
  vertices.back() = target;
  for (std::size_t i = planes.size(); i > 0; --i) {
    vertices[i] = meet(planes[i - 1], vertices[i + 1], vertices[i]);
  }
}

}  // namespace rayloc
