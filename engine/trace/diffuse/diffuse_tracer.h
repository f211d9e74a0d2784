// DiffuseTracer: power that the rough surfaces of a scene scatter from one antenna to another,
// once, with reflections before or after on request, and through objects if the options allow it.
//
// The surfaces are integrated over adaptively: triangles are halved where halving changes the power
// most, until the estimated error is small. Both ends must see a point (leg_finder.h); at a
// shadow's edge this limits the accuracy. Reflected and scattered power together are the power that
// smooth surfaces would reflect: paths are to be traced with TraceOptions::diffuse too.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "engine/base/expected.h"
#include "engine/trace/diffuse/diffuse_density.h"
#include "engine/trace/diffuse/rough_materials.h"
#include "engine/trace/parameter.h"
#include "engine/trace/radio_device.h"
#include "engine/trace/trace_context.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

struct DiffuseOptions {
  int reflections = 0;      // total, before and after the scattering; 0 to 2
  double tolerance = 0.01;  // of the power
  // A count, chosen: less than a second in a room. No cell is divided beyond it; each rough face is
  // still evaluated once.
  std::size_t most_points = 500'000;
};

class DiffuseTracer {
 public:
  // `trace`: its depth counts the scattering as one interaction; softness and diffraction are
  // ignored. REQUIRES: scene != nullptr, 0 <= reflections <= 2, tolerance > 0.
  DiffuseTracer(std::shared_ptr<const Scene> scene,
                const TraceOptions& trace,
                const DiffuseOptions& options = {});

  // Without a rough surface there is no echo.
  DiffuseDensity density(const Transmitter& transmitter, const Receiver& receiver) const;

  // The same points of the same faces, with other ends or in a scene whose materials differ.
  DiffuseDensity again(const DiffuseDensity& density,
                       const Transmitter& transmitter,
                       const Receiver& receiver) const;

  // Derivatives of every echo; points and shadows are fixed. `density`: of these ends. An Error as
  // in check_parameter(), and for parameters that move faces, which would move the points.
  Expected<DiffuseDerivatives> differentiate(const DiffuseDensity& density,
                                             const Transmitter& transmitter,
                                             const Receiver& receiver,
                                             std::span<const Parameter> parameters) const;

 private:
  class Integration;
  template <int N>
  DiffuseDerivatives run(const DiffuseDensity& density,
                         const Transmitter& transmitter,
                         const Receiver& receiver,
                         std::span<const Parameter> parameters) const;

  std::shared_ptr<const TraceContext> context_;
  DiffuseOptions options_;
  RoughMaterials materials_;
};

}  // namespace rayloc
