#include "engine/trace/diffuse/rough_materials.h"

#include <algorithm>

namespace rayloc {

TraceOptions diffuse_options(const TraceOptions& trace) {
  TraceOptions options = trace;
  options.diffuse = true;
  options.softness = 0.0;
  options.diffraction = false;
  return options;
}

Expected<void> check_scatters(const Scene& scene) {
  const auto is_rough = [](const RadioMaterial& material) {
    return material.scattering.is_rough();
  };
  if (std::any_of(scene.materials().begin(), scene.materials().end(), is_rough)) {
    return {};
  }
  return bad_input(
      "no material of the scene scatters; state its scattering_coefficient, in its <bsdf> or under "
      "[materials.NAME] of the site");
}

RoughMaterials::RoughMaterials(const TraceContext& context) {
  const Scene& scene = *context.scene;
  materials_.resize(scene.materials().size());
  material_.reserve(scene.surfaces().size());
  for (std::uint32_t surface = 0; surface < scene.surfaces().size(); ++surface) {
    const std::uint32_t material = scene.objects()[scene.owner(surface).object].material;
    material_.push_back(material);
    const SurfaceScattering& rough = scene.materials()[material].scattering;
    // A material that reflects nothing, such as air, scatters nothing either.
    const auto reflects = [&] {
      const auto reflectance = reflectance_of<double>(context.facets[surface], context.wavelength);
      return *std::min_element(reflectance.begin(), reflectance.end()) > 0.0;
    };
    if (rough.is_rough() && !materials_[material] && reflects()) {
      const LobeShape<double> shape{rough.pattern, rough.alpha_r, rough.alpha_i, rough.lambda};
      materials_[material].emplace(
          OfMaterial{{lobe_of<double>(shape, context.facets[surface], context.wavelength),
                      rough.scattering_coefficient,
                      rough.xpd_coefficient},
                     surface});
    }
  }
}

}  // namespace rayloc
