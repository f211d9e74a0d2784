#include "tests/bench/known_paths.h"

#include <array>
#include <span>

#include "engine/base/check.h"
#include "engine/base/constants.h"
#include "engine/trace/image_method.h"

namespace rayloc::bench {
namespace {

constexpr std::size_t kMaxDepth = 8;

}  // namespace

KnownPaths::KnownPaths(const ReceiverTracer& at,
                       const PathTracer& tracer,
                       const Transmitter& transmitter)
    : transmitter_(link_end(transmitter)),
      receiver_(link_end(at.receiver())),
      wavelength_(tracer.wavelength()) {
  const Scene& scene = tracer.scene();
  for (const Path& path : at.trace(transmitter)) {
    RAYLOC_CHECK(path.interactions.size() <= kMaxDepth);
    for (const Interaction& interaction : path.interactions) {
      interactions_.push_back(interaction);
      const RadioMaterial& material = scene.material_of(interaction.surface);
      planes_.push_back(scene.surfaces()[interaction.surface].plane());
      facets_.push_back({planes_.back(),
                         complex_permittivity(material, scene.carrier_hz()),
                         material.thickness,
                         {}});
    }
    ends_.push_back(planes_.size());
  }
}

double KnownPaths::evaluate() const {
  std::array<Vec3d, kMaxDepth + 2> vertices;
  double sum = 0.0;
  std::size_t first = 0;
  for (const std::size_t end : ends_) {
    const std::size_t depth = end - first;
    const std::span<Vec3d> used(vertices.data(), depth + 2);
    reflection_vertices<double>(
        transmitter_.position, std::span(planes_).subspan(first, depth), receiver_.position, used);
    const PathCoefficient<double> path =
        path_coefficient<double>(std::span(interactions_).subspan(first, depth),
                                 std::span(facets_).subspan(first, depth),
                                 transmitter_,
                                 receiver_,
                                 wavelength_);
    sum += used[depth / 2].x + path.a.re + path.a.im + path.length / kSpeedOfLight;
    first = end;
  }
  return sum;
}

}  // namespace rayloc::bench
