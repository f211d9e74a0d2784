// What a body at a movable place adds to the channel of a link: H = H_empty + scattered paths.
//
//   auto tracer = TargetTracer::create(scene, body);
//   TargetLink link = tracer->link(transmitter, receiver);  // image trees built once ...
//   for (...) h = h_empty + link.trace({x, y})->cfr(grid);   // ... and used for every place
//
// Each wave that reaches the body (over chains of mirrors from the transmitter) leaves it over each
// chain to the receiver; a pair scatters as a point source at the image of the one device to the
// image of the other would past the body alone (em/cylinder_scatterer.h). That is the shadow on
// every path of the empty scene too: the pair of the chains before and behind the body cancels it.
// Waves that meet the body twice are left out.
//
// A pair meets the body at the height where the straight line between both images passes it; what
// is in the way, and the reflections, are those of the rays to this point (in the height of the
// body, softly limited: what the ends of the body diffract comes from them).
//
// Derivatives are by the place alone. The body's size, height and material have none here, nor have
// the devices and the scene past a body: there is no argument to ask for them.
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
  // `max_depth` bounds the interactions of both rays together, the body not counted.
  TraceOptions trace;
  // Pairs whose rays carry less than this share of the amplitude of free space over the link's
  // distance are left out, the body taken as a mirror with a gain of 4 (a lens of wood has 3): each
  // pair left out is smaller than that.
  double negligible = 1e-4;
  // Chains of mirrors are looked for at heights this far apart on the body [m].
  double height_step = 0.4;
};

// A pair is a path: interactions are those of the incident ray, then those of the outgoing one (the
// body is none of them); order: fewest interactions, then of the incident ray, then by their
// surfaces.
struct TargetPaths {
  Paths paths;
  PathDerivatives by_position;  // parameter 0: x, 1: y [1/m]
};

struct ScatteringContext;  // what all links past one body share

class TargetLink {
 public:
  // An Error when the position is not finite or an end of the link is inside the body there.
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
  // An Error that names the value of the body or of the options that cannot be used.
  // REQUIRES: scene != nullptr.
  static Expected<TargetTracer> create(std::shared_ptr<const Scene> scene,
                                       const TargetBody& body,
                                       const ScatteringOptions& options = {});

  // Builds the image trees of both ends.
  TargetLink link(const Transmitter& transmitter, const Receiver& receiver) const;
  // One transmitter, heard by many antennas: its tree is built once.
  std::vector<TargetLink> links(const Transmitter& transmitter,
                                std::span<const Receiver> receivers) const;

 private:
  explicit TargetTracer(std::shared_ptr<const ScatteringContext> shared)
      : shared_(std::move(shared)) {}

  std::shared_ptr<const ScatteringContext> shared_;
};

}  // namespace rayloc
