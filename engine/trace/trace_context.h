// TraceContext: what all tracers of one scene share; immutable.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/scene/bvh.h"
#include "engine/scene/scene.h"
#include "engine/scene/wedges.h"
#include "engine/trace/coplanar_faces.h"
#include "engine/trace/diffraction/edge_path.h"
#include "engine/trace/field_calculator.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

struct TraceContext {
  // REQUIRES: scene != nullptr, options.max_depth >= 0, options.softness finite and >= 0,
  // not both softness and diffraction, no double diffraction without diffraction.
  TraceContext(std::shared_ptr<const Scene> scene, const TraceOptions& options);
  TraceContext(const TraceContext&) = delete;
  TraceContext& operator=(const TraceContext&) = delete;

  // Every surface that the segment meets, soft edges included.
  void crossings(const Segment& segment, std::vector<Crossing>& found) const;

  MetWedge wedge(std::uint32_t edge) const;

  std::shared_ptr<const Scene> scene;
  TraceOptions options;
  double wavelength = 0.0;             // [m]
  std::vector<SlabTable> slab_tables;  // of each material
  std::vector<Facet<double>> facets;   // of each surface; they point to the tables
  std::vector<bool> opaque;            // of each surface: nothing that counts goes through it
  // Of each surface, what other objects have at its place (a door flush with its wall). With
  // transmission all of them act; without those that are before it do, where both would.
  std::vector<std::vector<CoplanarFace>> coplanar_faces;  // with transmission, else none
  std::vector<std::vector<std::uint32_t>> covers;         // without, else none
  bool has_covers = false;
  std::vector<Wedge> wedges;    // only with diffraction
  std::optional<Bvh> soft_bvh;  // only with soft edges
};

}  // namespace rayloc
