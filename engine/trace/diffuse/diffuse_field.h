// DiffuseField: one realisation of a room with given phases of its rough surfaces, for a simulator.
//
// Surfaces are cut into patches once, independent of the ends; each has a phase, and one for the
// other polarisation, by the seed alone. So nearby antennas and a moving device see the same
// scatterers: the field changes smoothly over a wavelength. Over all seeds the mean power is that
// of DiffuseDensity, for patches that are small compared with the distance of both ends.
//
//   DiffuseField field(scene, trace);
//   const DiffuseField::End at_ap = field.lit_by(receiver);     // once
//   const Paths diffuse = field.between(field.lit_by(transmitter), at_ap);
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/trace/diffuse/rough_materials.h"
#include "engine/trace/diffuse/scattered_path.h"
#include "engine/trace/paths.h"
#include "engine/trace/radio_device.h"
#include "engine/trace/trace_context.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

struct DiffuseFieldOptions {
  int reflections = 0;    // total, before and after the scattering
  double spacing = 0.25;  // [m], no edge of a patch is longer; chosen
  std::uint64_t seed = 0;
};

class DiffuseField {
 public:
  // Arguments as in DiffuseTracer. REQUIRES: spacing > 0.
  DiffuseField(std::shared_ptr<const Scene> scene,
               const TraceOptions& trace,
               const DiffuseFieldOptions& options = {});

  // The waves from one end: one for each path to each patch.
  class End {
    friend class DiffuseField;
    struct Lit {
      LegToPatch<double> leg;
      std::uint32_t patch = 0;
      bool above = false;         // on the side of the surface's normal
      std::uint64_t mirrors = 0;  // set of mirrors, in any order
      std::uint32_t mirror_count = 0;
      std::uint32_t met = 0;  // number of interactions
    };
    std::vector<Lit> lit_;  // patch by patch
  };
  End lit_by(const RadioDevice& device) const;

  // A path over each patch that both light. The paths have no interactions, only a field.
  Paths between(const End& transmitter, const End& receiver) const;

  std::size_t patch_count() const { return patches_.size(); }

 private:
  Path path(const End::Lit& in, const End::Lit& out) const;

  std::shared_ptr<const TraceContext> context_;
  DiffuseFieldOptions options_;
  RoughMaterials materials_;
  std::vector<ScatteringPatch> patches_;
};

}  // namespace rayloc
