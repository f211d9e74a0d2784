// The coefficient of a path under soft visibility (visibility.h).
//
// A crossing with a blocking weight w lets 1 - w of the wave pass. With transmission w of the wave
// passes through the slab instead, which is one more interaction: since `max_depth` counts
// interactions, the field is kept apart by their number and the part beyond the depth is lost. The
// sum over these fields is continuous where a cut by the number of crossings would jump.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/trace/field_calculator.h"
#include "engine/trace/interactions/interaction.h"
#include "engine/trace/trace_context.h"
#include "engine/trace/trace_options.h"
#include "engine/trace/visibility.h"

namespace rayloc {

// An interaction of a path, in path order.
template <typename T>
struct SoftInteraction {
  InteractionKind kind = InteractionKind::kReflection;
  const Surface* surface = nullptr;
  Facet<T> facet;
  // For a mirror: coincident surfaces that reflect in its place (TraceContext::covers).
  struct Cover {
    const Surface* surface = nullptr;
    Facet<T> facet;
  };
  std::vector<Cover> covers = {};
  bool at_mirror = false;  // Interaction::at_mirror
};

// `facet_of(surface)` returns a Facet<T>.
template <typename T, typename FacetOf>
SoftInteraction<T> soft_interaction(const TraceContext& context,
                                    InteractionKind kind,
                                    std::uint32_t surface,
                                    const FacetOf& facet_of) {
  const auto& surfaces = context.scene->surfaces();
  SoftInteraction<T> interaction{kind, &surfaces[surface], facet_of(surface)};
  if (is_mirror(kind)) {
    for (const std::uint32_t cover : context.covers[surface]) {
      interaction.covers.push_back({&surfaces[cover], facet_of(cover)});
    }
  }
  return interaction;
}

template <typename T>
class SoftPath {
 public:
  // REQUIRES: options.softness > 0; the arguments outlive the SoftPath.
  SoftPath(std::span<const SoftInteraction<T>> interactions,
           const LinkEnd<T>& transmitter,
           const LinkEnd<T>& receiver,
           T wavelength,
           const TraceOptions& options)
      : interactions_(interactions),
        transmitter_(transmitter),
        receiver_(receiver),
        wavelength_(std::move(wavelength)),
        options_(options) {
    std::vector<Plane<T>> planes;
    for (const SoftInteraction<T>& interaction : interactions) {
      if (is_mirror(interaction.kind)) {
        planes.push_back(interaction.facet.plane);
        mirrors_.push_back(&interaction);
      }
    }
    vertices_.resize(planes.size() + 2);
    reflection_vertices<T>(transmitter.position, planes, receiver.position, vertices_);
  }

  // Transmitter, points of reflection, receiver.
  std::span<const Vec3<T>> vertices() const { return vertices_; }

  // Segment `i`, between vertices i and i + 1.
  SoftSegment<T> segment(std::size_t i) const {
    return {vertices_[i],
            vertices_[i + 1],
            i == 0 ? nullptr : &mirrors_[i - 1]->facet.plane.normal,
            i == mirrors_.size() ? nullptr : &mirrors_[i]->facet.plane.normal};
  }

  // Weight of the path from its points of reflection and its shortest segments; 0: no path.
  T mirror_weight() const {
    T weight(1);
    const double softness = options_.softness;
    for (std::size_t i = 0; i < mirrors_.size(); ++i) {
      const SoftInteraction<T>& mirror = *mirrors_[i];
      weight = weight * edge_weight(*mirror.surface, mirror.facet, vertices_[i + 1], softness);
      for (const auto& cover : mirror.covers) {
        weight =
            weight * (T(1) - edge_weight(*cover.surface, cover.facet, vertices_[i + 1], softness));
      }
      if (i > 0) {
        weight = weight * corner_weight(vertices_[i],
                                        vertices_[i + 1],
                                        mirrors_[i - 1]->facet.plane.normal,
                                        mirror.facet.plane.normal,
                                        softness);
      }
    }
    if (!mirrors_.empty()) {
      weight = weight * end_weight(*mirrors_.front(), vertices_[0], vertices_[1]);
      weight = weight * end_weight(*mirrors_.back(), vertices_.back(), vertices_[mirrors_.size()]);
    }
    return weight;
  }

  PathCoefficient<T> coefficient() const {
    PathCoefficient<T> path;
    for (std::size_t i = 0; i + 1 < vertices_.size(); ++i) {
      path.length = path.length + norm(vertices_[i + 1] - vertices_[i]);
    }
    path.departure = normalized(vertices_[1] - vertices_[0]);
    Passage passage{{radiated(transmitter_, path.departure)}};
    for (const SoftInteraction<T>& interaction : interactions_) {
      visit_interaction(interaction.kind, [&](auto met) { pass(met, interaction, passage); });
    }
    const T weight = mirror_weight();
    path.arrival = passage.waves.front().direction;
    for (const Wave<T>& wave : passage.waves) {
      path.a = path.a + received(receiver_, wave, path.length, wavelength_);
    }
    path.a = {weight * path.a.re, weight * path.a.im};
    return path;
  }

 private:
  // State of the wave along the path.
  struct Passage {
    std::vector<Wave<T>> waves;  // by the number of faces crossed so far
    std::size_t mirrors = 0;     // passed so far
  };

  T end_weight(const SoftInteraction<T>& mirror,
               const Vec3<T>& device,
               const Vec3<T>& point) const {
    return foot_weight(*mirror.surface, mirror.facet, device, point, options_.softness);
  }

  // The share of the wave that the surface blocks.
  T blocked_share(const SoftInteraction<T>& interaction, const SoftSegment<T>& along) const {
    const Facet<T>& facet = interaction.facet;
    const Vec3<T> point = meet(facet.plane, along.from, along.to);
    return interaction.at_mirror
               ? edge_weight(*interaction.surface, facet, point, options_.softness)
               : crossing_weight(*interaction.surface, facet, along, point, options_.softness);
  }

  void pass(interactions::Reflection /*met*/,
            const SoftInteraction<T>& interaction,
            Passage& passage) const {
    for (Wave<T>& wave : passage.waves) {
      wave = interactions::Reflection::apply(wave, interaction.facet, wavelength_);
    }
    ++passage.mirrors;
  }

  void pass(interactions::Shadowing /*met*/,
            const SoftInteraction<T>& interaction,
            Passage& passage) const {
    const T weight = blocked_share(interaction, segment(passage.mirrors));
    Wave<T>& wave = passage.waves.front();
    wave.field = Complex<T>{T(1) - weight, T(0)} * wave.field;
  }

  void pass(interactions::Diffraction /*met*/,
            const SoftInteraction<T>& /*interaction*/,
            Passage& /*passage*/) const {
    check_failed("a path over an edge has hard edges", __FILE__, __LINE__);
  }

  void pass(interactions::Transmission /*met*/,
            const SoftInteraction<T>& interaction,
            Passage& passage) const {
    std::vector<Wave<T>>& waves = passage.waves;
    const T weight = blocked_share(interaction, segment(passage.mirrors));
    const Complex<T> past{T(1) - weight, T(0)};
    const std::size_t most = static_cast<std::size_t>(options_.max_depth) - mirrors_.size();
    if (waves.size() <= most) {
      waves.push_back({{}, waves.front().direction});
    }
    for (std::size_t i = waves.size(); i > 0; --i) {
      Wave<T>& wave = waves[i - 1];
      wave.field = past * wave.field;
      if (i > 1) {
        const Wave<T> through =
            interactions::Transmission::apply(waves[i - 2], interaction.facet, wavelength_);
        wave.field = wave.field + Complex<T>{weight, T(0)} * through.field;
      }
    }
  }

  std::span<const SoftInteraction<T>> interactions_;
  const LinkEnd<T>& transmitter_;
  const LinkEnd<T>& receiver_;
  T wavelength_;
  TraceOptions options_;
  std::vector<const SoftInteraction<T>*> mirrors_;
  std::vector<Vec3<T>> vertices_;
};

}  // namespace rayloc
