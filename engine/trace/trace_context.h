// TraceContext: immutable data that all tracers of one scene share.
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

  // Finds every surface that the segment meets, soft edges included.
  void crossings(const Segment& segment, std::vector<Crossing>& found) const;

  MetWedge wedge(std::uint32_t edge) const;

  std::shared_ptr<const Scene> scene;
  TraceOptions options;
  double wavelength = 0.0;             // [m]
  std::vector<SlabTable> slab_tables;  // one per material
  std::vector<Facet<double>> facets;   // one per surface; they point to the tables
  std::vector<bool> opaque;            // one per surface: transmission is negligible
  // For each surface the coincident surfaces of other objects (a door flush with its wall). With
  // transmission all of them act; without it the preceding ones act where both would.
  std::vector<std::vector<CoplanarFace>> coplanar_faces;  // with transmission, otherwise empty
  std::vector<std::vector<std::uint32_t>> covers;         // without transmission, otherwise empty
  bool has_covers = false;
  std::vector<Wedge> wedges;    // only with diffraction
  std::optional<Bvh> soft_bvh;  // only with soft edges
};

}  // namespace rayloc
