#include "engine/trace/trace_context.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/constants.h"

namespace rayloc {
namespace {

// Amplitude of a wave after one crossing, below which a surface is opaque: -240 dB.
constexpr double kOpaque = 1e-12;

bool is_opaque(const Facet<double>& facet, double wavelength) {
  const SlabCoefficients<double> slab =
      facet_coefficients(1.0, facet, wavelength);  // normal incidence
  return abs2(slab.t_te) < kOpaque * kOpaque;
}

// For each face the coincident faces that act where both would: the preceding ones. Opaque bodies
// only reflect outwards, so faces back to back do not compete.
std::vector<std::vector<std::uint32_t>> find_covers(
    const Scene& scene, const std::vector<std::vector<CoplanarFace>>& coplanar) {
  std::vector<std::vector<std::uint32_t>> covers(coplanar.size());
  for (std::uint32_t i = 0; i < coplanar.size(); ++i) {
    for (const CoplanarFace& face : coplanar[i]) {
      const bool back_to_back = scene.owner(i).one_facing && scene.owner(face.surface).one_facing &&
                                dot(scene.surfaces()[i].plane().normal,
                                    scene.surfaces()[face.surface].plane().normal) < 0.0;
      if (face.surface < i && !back_to_back) {
        covers[i].push_back(face.surface);
      }
    }
  }
  return covers;
}

}  // namespace

TraceContext::TraceContext(std::shared_ptr<const Scene> the_scene, const TraceOptions& the_options)
    : scene(std::move(the_scene)), options(the_options) {
  RAYLOC_CHECK(scene != nullptr && options.max_depth >= 0);
  RAYLOC_CHECK(std::isfinite(options.softness) && options.softness >= 0.0);
  RAYLOC_CHECK(options.softness == 0.0 || !options.diffraction);
  RAYLOC_CHECK(options.diffraction || !options.double_diffraction);
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
    if (options.diffuse) {
      facets.back().specular = material.scattering.specular_factor();
    }
    opaque.push_back(is_opaque(facets.back(), wavelength));
  }
  auto coplanar = find_coplanar_faces(*scene, options);
  coplanar_faces.resize(coplanar.size());
  covers.resize(coplanar.size());
  if (options.transmission) {
    coplanar_faces = std::move(coplanar);
  } else {
    covers = find_covers(*scene, coplanar);
  }
  has_covers = std::any_of(covers.begin(), covers.end(), [](const auto& c) { return !c.empty(); });
  if (options.diffraction) {
    wedges = find_wedges(*scene);
  }
  if (options.softness > 0.0) {
    auto bvh = Bvh::create(scene->surfaces(), options.softness);
    RAYLOC_CHECK(bvh.has_value());  // Embree has already worked for the scene
    soft_bvh = std::move(*bvh);
  }
}

MetWedge TraceContext::wedge(std::uint32_t edge) const {
  const Wedge& wedge = wedges[edge];
  const WedgeBody through = wedge.is_free() ? WedgeBody::kSheet : WedgeBody::kSolid;
  return {wedge, options.transmission ? through : WedgeBody::kOpaque};
}

void TraceContext::crossings(const Segment& segment, std::vector<Crossing>& found) const {
  if (soft_bvh.has_value()) {
    soft_bvh->crossings(segment, found);
  } else {
    scene->crossings(segment, found);
  }
}

}  // namespace rayloc
