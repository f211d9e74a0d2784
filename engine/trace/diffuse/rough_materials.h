// RoughMaterials: the materials of a scene that scatter, each with its lobe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/base/expected.h"
#include "engine/em/scattering_lobe.h"
#include "engine/trace/diffuse/scattered_path.h"
#include "engine/trace/dual_link.h"
#include "engine/trace/trace_context.h"

namespace rayloc {

// Options for scattered paths: hard edges, and paths that end at the scatterer.
TraceOptions diffuse_options(const TraceOptions& trace);

// An Error for a scene without a scattering surface.
Expected<void> check_scatters(const Scene& scene);

// `facet`: of any surface of the material.
template <typename T>
typename ScatteringLobe<T>::AtNodes reflectance_of(const Facet<T>& facet, const T& wavelength) {
  typename ScatteringLobe<T>::AtNodes reflectance;
  for (std::size_t i = 0; i < kLobeNodes; ++i) {
    reflectance[i] = smooth_reflectance(T(lobe_nodes().cosine[i]), facet, wavelength);
  }
  return reflectance;
}
// REQUIRES: the material reflects.
template <typename T>
ScatteringLobe<T> lobe_of(const LobeShape<T>& shape, const Facet<T>& facet, const T& wavelength) {
  return {shape, reflectance_of(facet, wavelength)};
}

class RoughMaterials {
 public:
  explicit RoughMaterials(const TraceContext& context);

  // nullptr for a smooth surface.
  const RoughMaterial<double>* of_surface(std::uint32_t surface) const {
    const auto& found = materials_[material_[surface]];
    return found ? &found->rough : nullptr;
  }

  // All of them in dual numbers, by surface.
  template <int N>
  class Duals {
   public:
    Duals(const RoughMaterials& materials,
          const TraceContext& context,
          const ParameterBlock<N>& block);
    // REQUIRES: the surface is rough.
    const RoughMaterial<Dual<N>>& of_surface(std::uint32_t surface) const {
      return *materials_[material_[surface]];
    }

   private:
    const std::vector<std::uint32_t>& material_;
    std::vector<std::optional<RoughMaterial<Dual<N>>>> materials_;
  };

 private:
  struct OfMaterial {
    RoughMaterial<double> rough;
    std::uint32_t surface = 0;  // one of its surfaces
  };

  std::vector<std::uint32_t> material_;  // of each surface
  std::vector<std::optional<OfMaterial>> materials_;
};

template <int N>
RoughMaterials::Duals<N>::Duals(const RoughMaterials& materials,
                                const TraceContext& context,
                                const ParameterBlock<N>& block)
    : material_(materials.material_), materials_(materials.materials_.size()) {
  using Kind = Parameter::Kind;
  for (std::uint32_t m = 0; m < materials_.size(); ++m) {
    if (!materials.materials_[m]) {
      continue;
    }
    const auto& [rough, surface] = *materials.materials_[m];
    RoughMaterial<Dual<N>> dual{
        ScatteringLobe<Dual<N>>(rough.lobe), Dual<N>(rough.scattering), Dual<N>(rough.xpd)};
    block.seed(dual.scattering, Kind::kScatteringCoefficient, m, 0, 1.0);
    block.seed(dual.xpd, Kind::kXpdCoefficient, m, 0, 1.0);
    if (block.varies(m)) {
      LobeShape<Dual<N>> shape = dual.lobe.shape();
      block.seed(shape.alpha_r, Kind::kAlphaReflected, m, 0, 1.0);
      block.seed(shape.alpha_i, Kind::kAlphaBack, m, 0, 1.0);
      block.seed(shape.lambda, Kind::kLobeShare, m, 0, 1.0);
      dual.lobe = lobe_of<Dual<N>>(
          shape, dual_facet<N>(context, surface, block), Dual<N>(context.wavelength));
    }
    materials_[m] = dual;
  }
}

}  // namespace rayloc
