#include "engine/trace/trace_context.h"

#include <cmath>
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
      facet_coefficients(facet.plane.normal, facet, wavelength);  // normal incidence
  return abs2(slab.t_te) < kOpaque * kOpaque;
}

bool are_coplanar(const Plane<double>& a, const Plane<double>& b) {
  const double along = dot(a.normal, b.normal);
  return std::abs(along) > kParallel &&
         std::abs(a.offset - (along > 0.0 ? b.offset : -b.offset)) < kSamePlane;
}

bool has_coplanar_objects(const Scene& scene) {
  for (std::uint32_t i = 0; i < scene.surfaces().size(); ++i) {
    for (std::uint32_t j = 0; j < i; ++j) {
      if (scene.owner(i).object != scene.owner(j).object &&
          are_coplanar(scene.surfaces()[i].plane(), scene.surfaces()[j].plane())) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

TraceContext::TraceContext(std::shared_ptr<const Scene> the_scene, const TraceOptions& the_options)
    : scene(std::move(the_scene)), options(the_options) {
  RAYLOC_CHECK(scene != nullptr && options.max_depth >= 0);
  RAYLOC_CHECK(std::isfinite(options.softness) && options.softness >= 0.0);
  wavelength = kSpeedOfLight / scene->carrier_hz();
  facets.reserve(scene->surfaces().size());
  for (std::uint32_t i = 0; i < scene->surfaces().size(); ++i) {
    const RadioMaterial& material = scene->material_of(i);
    facets.push_back({scene->surfaces()[i].plane(),
                      complex_permittivity(material, scene->carrier_hz()),
                      material.thickness,
                      {}});
    opaque.push_back(is_opaque(facets.back(), wavelength));
  }
  has_coplanar_objects = rayloc::has_coplanar_objects(*scene);
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
