// Effect of a body at a movable position on the channel of a link: H = H_empty + scattered paths.
//
//   auto tracer = TargetTracer::create(scene, body);
//   TargetLink link = tracer->link(transmitter, receiver);  // image trees built once ...
//   for (...) h = h_empty + link.trace({x, y})->cfr(grid);   // ... and used for every place
//
// Each wave that reaches the body (over chains of mirrors from the transmitter) leaves it over each
// chain to the receiver; a pair scatters as the body alone would scatter a point source at the
// image of the one device to the image of the other (em/cylinder_scatterer.h). That includes the
// shadow on every path of the empty scene: the pair of the chains before and behind the body
// cancels it. Waves that meet the body twice are left out.
//
// A pair meets the body at the height where the straight line between both images passes it;
// obstructions and reflections are those of the rays to this point (in the height of the body,
// softly limited: diffraction at the ends of the body starts from them).
//
// Derivatives are with respect to the position alone. The body's size, height and material have
// none here, nor have the devices and the scene: there is no argument to request them.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/expected.h"
#include "engine/scene/scene.h"
#include "engine/trace/path_derivatives.h"
#include "engine/trace/paths.h"
#include "engine/trace/radio_device.h"
#include "engine/trace/scattering/target_body.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

struct ScatteringOptions {
  // `max_depth` bounds the interactions of both rays together, excluding the body.
  TraceOptions trace;
  // Pairs whose rays carry less than this share of the amplitude of free space over the link's
  // distance are left out, assuming the body as a mirror with a gain of 4 (a lens of wood has 3):
  // each pair left out is smaller than that.
  double negligible = 1e-4;
  // Chains of mirrors are searched at heights this far apart on the body [m].
  double height_step = 0.4;
};

// A pair is a path: interactions are those of the incident ray, then those of the
// outgoing one (without the body); order: fewest interactions, then of the incident ray,
// then by their surfaces.
struct TargetPaths {
  Paths paths;
  PathDerivatives by_position;  // parameter 0: x, 1: y [1/m]
};

struct ScatteringContext;  // data shared by all links past one body

class TargetLink {
 public:
  // An Error when the position is not finite or a link end would be inside the body.
  Expected<Paths> trace(const TargetPosition& position) const;
  Expected<TargetPaths> differentiate(const TargetPosition& position) const;

 private:
  friend class TargetTracer;
  class Impl;
  explicit TargetLink(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

  std::shared_ptr<const Impl> impl_;
};

class TargetTracer {
 public:
  // An Error that names the invalid value of the body or of the options. REQUIRES:
  // scene != nullptr.
  static Expected<TargetTracer> create(std::shared_ptr<const Scene> scene,
                                       const TargetBody& body,
                                       const ScatteringOptions& options = {});

  // Builds the image trees of both ends.
  TargetLink link(const Transmitter& transmitter, const Receiver& receiver) const;
  // One transmitter and many receiving antennas: its tree is built once.
  std::vector<TargetLink> links(const Transmitter& transmitter,
                                std::span<const Receiver> receivers) const;

 private:
  explicit TargetTracer(std::shared_ptr<const ScatteringContext> shared)
      : shared_(std::move(shared)) {}

  std::shared_ptr<const ScatteringContext> shared_;
};

}  // namespace rayloc
