#include "engine/trace/diffuse/diffuse_field.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/constants.h"
#include "engine/base/normal_draws.h"
#include "engine/trace/diffuse/leg_finder.h"
#include "engine/trace/diffuse/surface_patches.h"

namespace rayloc {
namespace {

// On the unit circle.
Complex<double> phase(std::uint64_t number) {
  constexpr double kPerCircle = 0x1p-53;  // the upper 53 bits are a double in [0, 1)
  const double angle =
      2.0 * std::numbers::pi * kPerCircle * static_cast<double>(mixed(number) >> 11U);
  return {std::cos(angle), std::sin(angle)};
}

Complex<double> scaled(double by, const Complex<double>& z) { return {by * z.re, by * z.im}; }

}  // namespace

DiffuseField::DiffuseField(std::shared_ptr<const Scene> scene,
                           const TraceOptions& trace,
                           const DiffuseFieldOptions& options)
    : context_(std::make_shared<const TraceContext>(std::move(scene), diffuse_options(trace))),
      options_(options),
      materials_(*context_) {
  RAYLOC_CHECK(options.spacing > 0.0 && options.reflections >= 0);
  for (std::uint32_t surface = 0; surface < context_->facets.size(); ++surface) {
    if (materials_.of_surface(surface) == nullptr) {
      continue;
    }
    std::vector<SurfaceTriangle> pieces;
    for (const SurfaceTriangle& triangle : triangles_of(*context_->scene, surface)) {
      cut(
          triangle, [&](const SurfaceTriangle&) { return options.spacing; }, pieces);
    }
    patches_.reserve(patches_.size() + pieces.size());
    for (const SurfaceTriangle& piece : pieces) {
      patches_.push_back({surface, piece.middle(), piece.area()});
    }
  }
}

DiffuseField::End DiffuseField::lit_by(const RadioDevice& device) const {
  const LinkEnd<double> end = link_end(device);
  const auto facet_of = [&](std::uint32_t surface) { return context_->facets[surface]; };
  LegFinder finder(context_, device.position, options_.reflections);
  End lit;
  for (std::uint32_t i = 0; i < patches_.size(); ++i) {
    const ScatteringPatch& patch = patches_[i];
    const Vec3d& normal = context_->facets[patch.surface].plane.normal;
    for (const bool above : {true, false}) {
      for (const FoundLeg& found : finder.find(patch.position, above ? normal : -normal)) {
        End::Lit one;
        one.leg = leg_to_patch<double>(
            end, found.interactions, facet_of, patch.position, context_->wavelength);
        one.patch = i;
        one.above = above;
        one.mirror_count = static_cast<std::uint32_t>(found.mirrors);
        one.met = static_cast<std::uint32_t>(found.interactions.size());
        for (const Interaction& interaction : found.interactions) {
          one.mirrors += is_mirror(interaction.kind) ? mixed(interaction.surface) : 0;
        }
        lit.lit_.push_back(one);
      }
    }
  }
  return lit;
}

Path DiffuseField::path(const End::Lit& in, const End::Lit& out) const {
  const ScatteringPatch& patch = patches_[in.patch];
  const RoughMaterial<double>& rough = *materials_.of_surface(patch.surface);
  const ScatteredPath<double> scattered = scattered_path<double>(
      rough, context_->facets[patch.surface], in.leg, out.leg, context_->wavelength);
  // Symmetric in both ends.
  const std::uint64_t number =
      mixed(options_.seed ^ mixed(2 * in.patch + (in.above ? 1 : 0))) + in.mirrors + out.mirrors;
  const double amplitude = std::sqrt(scattered.per_area * patch.area);
  const Complex<double> co = scaled(amplitude * std::sqrt(1.0 - rough.xpd), scattered.co);
  const Complex<double> cross = scaled(amplitude * std::sqrt(rough.xpd), scattered.cross);
  return {co * phase(number) + cross * phase(~number),
          scattered.length / kSpeedOfLight,
          in.leg.departure,
          out.leg.departure,
          {}};
}

Paths DiffuseField::between(const End& transmitter, const End& receiver) const {
  std::vector<Path> paths;
  paths.reserve(receiver.lit_.size());
  std::size_t first = 0;
  for (const End::Lit& in : transmitter.lit_) {
    while (first < receiver.lit_.size() && receiver.lit_[first].patch < in.patch) {
      ++first;
    }
    for (std::size_t i = first; i < receiver.lit_.size() && receiver.lit_[i].patch == in.patch;
         ++i) {
      const End::Lit& out = receiver.lit_[i];
      const auto most = static_cast<std::uint32_t>(options_.reflections);
      const auto depth = static_cast<std::uint32_t>(context_->options.max_depth);
      if (in.above == out.above && in.mirror_count + out.mirror_count <= most &&
          in.met + out.met + 1 <= depth) {
        paths.push_back(path(in, out));
      }
    }
  }
  return Paths(std::move(paths));
}

}  // namespace rayloc
