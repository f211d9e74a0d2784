// PlainEdgeSearch: every sequence of up to two mirrors about every edge, by images only. It is the
// reference for the tracer's paths over an edge.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <set>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/scene/wedges.h"
#include "engine/trace/image_method.h"

namespace rayloc::test {

struct PlainEdgeSearch {
  const Scene& scene;
  std::vector<Wedge> wedges = find_wedges(scene);

  using Chain = std::vector<std::uint32_t>;  // from an end onwards

  std::vector<Chain> chains() const {
    std::vector<Chain> all{{}};
    const auto count = static_cast<std::uint32_t>(scene.surfaces().size());
    for (std::uint32_t i = 0; i < count; ++i) {
      all.push_back({i});
    }
    for (std::uint32_t i = 0; i < count * count; ++i) {
      if (i / count != i % count) {
        all.push_back({i / count, i % count});
      }
    }
    return all;
  }

  Vec3d image(Vec3d end, const Chain& chain) const {
    for (const std::uint32_t i : chain) {
      end = mirror(scene.surfaces()[i].plane(), end);
    }
    return end;
  }

  bool is_inside(std::uint32_t object, const Vec3d& point) const {
    std::vector<Crossing> crossings;
    scene.crossings({point, point + Vec3d{173.0, 291.0, 57.0}}, crossings);
    return std::count_if(crossings.begin(),
                         crossings.end(),
                         [&](const Crossing& crossing) {
                           return scene.owner(crossing.surface).object == object;
                         }) %
               2 ==
           1;
  }

  // True for a face of a closed body on the side of `end`; any other face reflects on both sides.
  bool reflects(std::uint32_t number, const Vec3d& end, const Vec3d& from) const {
    const Scene::SurfaceOwner& owner = scene.owner(number);
    const Solid& solid = scene.solid(owner.object);
    if (!owner.one_facing || solid.shells == 0) {
      return true;
    }
    const double outside =
        static_cast<double>(solid.orientation) * distance(scene.surfaces()[number].plane(), from);
    return is_inside(owner.object, end) ? outside < 0.0 : outside > 0.0;
  }

  // True if the last mirror's plane contains the edge: such a mirror does not reflect the edge.
  bool is_in_mirror(const Wedge& wedge, const Chain& chain) const {
    if (chain.empty()) {
      return false;
    }
    const Plane<double>& plane = scene.surfaces()[chain.back()].plane();
    return std::abs(distance(plane, wedge.from)) < 2e-5 &&
           std::abs(distance(plane, wedge.to)) < 2e-5;
  }

  // True if the path from the end over the chain to the bend is free.
  bool is_free(const Vec3d& end, const Chain& chain, const Vec3d& bend, const Vec3d& beside) const {
    std::vector<Plane<double>> planes;
    for (const std::uint32_t i : chain) {
      planes.push_back(scene.surfaces()[i].plane());
    }
    std::vector<Vec3d> vertices(chain.size() + 2);
    reflection_vertices<double>(end, planes, bend, vertices);
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const double before = distance(planes[i], vertices[i]);
      const double after = distance(planes[i], vertices[i + 2]);
      if (before * after <= 0.0 || std::abs(before) < 1e-9 || std::abs(after) < 1e-9 ||
          !scene.surfaces()[chain[i]].contains(vertices[i + 1]) ||
          !reflects(chain[i], end, vertices[i])) {
        return false;
      }
    }
    vertices.back() = beside;
    for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
      if (scene.is_blocked({vertices[i],
                            vertices[i + 1],
                            i == 0 ? kNoSurface : chain[i - 1],
                            i == chain.size() ? kNoSurface : chain[i]})) {
        return false;
      }
    }
    return true;
  }

  // The height of the bend on the edge, which minimises the path length, by bisection; empty if it
  // is not on the edge.
  static std::optional<double> bend_at(const Wedge& wedge, const Vec3d& from, const Vec3d& to) {
    const auto slope = [&](double height) {
      const Vec3d at = wedge.from + height * wedge.along;
      return dot(wedge.along, normalized(at - from)) - dot(wedge.along, normalized(to - at));
    };
    double low = 0.0;
    double high = norm(wedge.to - wedge.from);
    if (slope(low) >= 0.0 || slope(high) <= 0.0) {
      return std::nullopt;
    }
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      (slope(middle) < 0.0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

  bool is_outside(const Wedge& wedge, const Vec3d& image) const {
    const Vec3d off = image - wedge.from;
    double azimuth = std::atan2(dot(off, wedge.normal), dot(off, wedge.in_face));
    azimuth += azimuth < 0.0 ? 2.0 * std::numbers::pi : 0.0;
    return azimuth <= wedge.n * std::numbers::pi;
  }

  // The interactions of each path from the transmitter on (a surface and 1000 for a reflection,
  // face 0 and the edge number for a diffraction), for paths with at most `most` reflections.
  std::set<std::vector<std::uint32_t>> find(const Vec3d& from, const Vec3d& to, std::size_t most) {
    std::set<std::vector<std::uint32_t>> found;
    const std::vector<Chain> all = chains();
    for (std::uint32_t edge = 0; edge < wedges.size(); ++edge) {
      const Wedge& wedge = wedges[edge];
      for (const Chain& before : all) {
        const Vec3d source = image(from, before);
        if (!is_outside(wedge, source)) {
          continue;
        }
        for (const Chain& after : all) {
          if (before.size() + after.size() > most) {
            break;  // chains are ordered by length
          }
          const Vec3d observer = image(to, after);
          if (!is_outside(wedge, observer)) {
            continue;
          }
          const auto height = bend_at(wedge, source, observer);
          if (!height) {
            continue;
          }
          const Vec3d bend = wedge.from + *height * wedge.along;
          // Outside the wedge, by more than the rounding of mesh coordinates.
          const double middle = 0.5 * wedge.n * std::numbers::pi;
          const Vec3d beside = bend + 2e-5 * std::cos(middle) * wedge.in_face +
                               2e-5 * std::sin(middle) * wedge.normal;
          if (is_in_mirror(wedge, before) || is_in_mirror(wedge, after) ||
              !is_free(from, before, bend, beside) || !is_free(to, after, bend, beside)) {
            continue;
          }
          std::vector<std::uint32_t> met;
          for (const std::uint32_t i : before) {
            met.insert(met.end(), {i, 1000U});
          }
          met.insert(met.end(), {wedge.face_0, edge});
          for (std::size_t i = after.size(); i > 0; --i) {
            met.insert(met.end(), {after[i - 1], 1000U});
          }
          found.insert(met);
        }
      }
    }
    return found;
  }
};

}  // namespace rayloc::test
