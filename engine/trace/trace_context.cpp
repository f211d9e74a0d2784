#include "engine/trace/trace_context.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/constants.h"

namespace rayloc {
namespace {

// Amplitude of a wave after one crossing, below which a surface is opaque: -240 dB.
constexpr double kOpaque = 1e-12;
// Faces nearer to each other than this are at the same place [m].
constexpr double kSamePlane = 1e-9;
constexpr double kParallel = 1.0 - 1e-12;

bool is_opaque(const Facet<double>& facet, double wavelength) {
  const SlabCoefficients<double> slab =
      facet_coefficients(1.0, facet, wavelength);  // normal incidence
  return abs2(slab.t_te) < kOpaque * kOpaque;
}

bool are_coplanar(const Plane<double>& a, const Plane<double>& b) {
  const double along = dot(a.normal, b.normal);
  return std::abs(along) > kParallel &&
         std::abs(a.offset - (along > 0.0 ? b.offset : -b.offset)) < kSamePlane;
}

struct Box {
  Vec3d lower;
  Vec3d upper;
};

Box box_around(const Surface& surface, double margin) {
  const Vec3d grow{margin, margin, margin};
  Box box{surface.outline().front(), surface.outline().front()};
  for (const Vec3d& p : surface.outline()) {
    box.lower = {
        std::min(box.lower.x, p.x), std::min(box.lower.y, p.y), std::min(box.lower.z, p.z)};
    box.upper = {
        std::max(box.upper.x, p.x), std::max(box.upper.y, p.y), std::max(box.upper.z, p.z)};
  }
  return {box.lower - grow, box.upper + grow};
}

bool overlap(const Box& a, const Box& b) {
  return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y &&
         b.lower.y <= a.upper.y && a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
}

// TraceContext::covers. Opaque bodies only reflect outwards, so faces back to back do not compete.
std::vector<std::vector<std::uint32_t>> find_covers(const Scene& scene,
                                                    const TraceOptions& options) {
  const auto& surfaces = scene.surfaces();
  std::vector<Box> boxes;
  boxes.reserve(surfaces.size());
  for (const Surface& surface : surfaces) {
    boxes.push_back(box_around(surface, options.softness + kSamePlane));
  }
  // Faces in one plane are equally far from the origin, so only neighbours need be compared.
  std::vector<std::uint32_t> by_distance(surfaces.size());
  std::iota(by_distance.begin(), by_distance.end(), 0U);
  const auto from_origin = [&](std::uint32_t i) { return std::abs(surfaces[i].plane().offset); };
  std::sort(by_distance.begin(), by_distance.end(), [&](std::uint32_t i, std::uint32_t j) {
    return from_origin(i) < from_origin(j);
  });
  std::vector<std::vector<std::uint32_t>> covers(surfaces.size());
  for (std::size_t first = 0; first < by_distance.size(); ++first) {
    for (std::size_t second = first + 1; second < by_distance.size(); ++second) {
      if (from_origin(by_distance[second]) - from_origin(by_distance[first]) >= kSamePlane) {
        break;
      }
      const auto [j, i] = std::minmax(by_distance[first], by_distance[second]);
      const Plane<double>& a = surfaces[i].plane();
      const Plane<double>& b = surfaces[j].plane();
      const bool back_to_back = !options.transmission && scene.owner(i).one_facing &&
                                scene.owner(j).one_facing && dot(a.normal, b.normal) < 0.0;
      if (scene.owner(i).object != scene.owner(j).object && !back_to_back &&
          overlap(boxes[i], boxes[j]) && are_coplanar(a, b)) {
        covers[i].push_back(j);
      }
    }
  }
  for (auto& list : covers) {
    std::sort(list.begin(), list.end());
  }
  return covers;
}

}  // namespace

TraceContext::TraceContext(std::shared_ptr<const Scene> the_scene, const TraceOptions& the_options)
    : scene(std::move(the_scene)), options(the_options) {
  RAYLOC_CHECK(scene != nullptr && options.max_depth >= 0);
  RAYLOC_CHECK(std::isfinite(options.softness) && options.softness >= 0.0);
  wavelength = kSpeedOfLight / scene->carrier_hz();
  slab_tables.reserve(scene->materials().size());
  for (const RadioMaterial& material : scene->materials()) {
    slab_tables.emplace_back(
        complex_permittivity(material, scene->carrier_hz()), material.thickness, wavelength);
  }
  facets.reserve(scene->surfaces().size());
  for (std::uint32_t i = 0; i < scene->surfaces().size(); ++i) {
    const RadioMaterial& material = scene->material_of(i);
    facets.push_back({scene->surfaces()[i].plane(),
                      complex_permittivity(material, scene->carrier_hz()),
                      material.thickness,
                      {},
                      &slab_tables[scene->objects()[scene->owner(i).object].material]});
    opaque.push_back(is_opaque(facets.back(), wavelength));
  }
  covers = find_covers(*scene, options);
  has_covers = std::any_of(covers.begin(), covers.end(), [](const auto& c) { return !c.empty(); });
  if (options.softness > 0.0) {
    auto bvh = Bvh::create(scene->surfaces(), options.softness);
    RAYLOC_CHECK(bvh.has_value());  // Embree worked for the scene itself
    soft_bvh = std::move(*bvh);
  }
}

void TraceContext::crossings(const Segment& segment, std::vector<Crossing>& found) const {
  if (soft_bvh.has_value()) {
    soft_bvh->crossings(segment, found);
  } else {
    scene->crossings(segment, found);
  }
}

}  // namespace rayloc
