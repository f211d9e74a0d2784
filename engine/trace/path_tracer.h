// PathTracer: the paths of a link: line of sight, specular reflections and, on request, straight
// transmission through objects and diffraction at one edge, exactly.
//
//   PathTracer tracer(scene);
//   Paths paths = tracer.trace(transmitter, receiver);
//
//   ReceiverTracer at_ap = tracer.at(receiver);   // image tree built once ...
//   for (...) h = at_ap.trace(transmitter).cfr(grid);  // ... and used for every position
//
// The result of a link depends on the scene, the options and its two ends alone; where shot rays
// propose (TraceOptions::candidates), also on the processor's rounding at edges.
// Thread safety: const members may be used from many threads.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/expected.h"
#include "engine/scene/scene.h"
#include "engine/trace/parameter.h"
#include "engine/trace/path_derivatives.h"
#include "engine/trace/paths.h"
#include "engine/trace/radio_device.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

class ImageTree;
class LitEdges;
class ReceiverTracer;
struct TraceContext;

class PathTracer {
 public:
  // REQUIRES: scene != nullptr, options.max_depth >= 0, options.softness finite and >= 0,
  // not both softness and diffraction. The carrier is that of the scene.
  explicit PathTracer(std::shared_ptr<const Scene> scene, const TraceOptions& options = {});

  // Builds an image tree at the receiver for this one link; use at() for many links.
  Paths trace(const Transmitter& transmitter, const Receiver& receiver) const;

  // A tracer for all transmitters of this receiver.
  ReceiverTracer at(const Receiver& receiver) const;
  // The same for several receivers, such as the elements of an array; receivers with nearly the
  // same view share an image tree. The result for each is that of at() for it alone.
  std::vector<ReceiverTracer> at(std::span<const Receiver> receivers) const;

  const Scene& scene() const;
  const TraceOptions& options() const;
  double wavelength() const;  // [m]

 private:
  std::shared_ptr<const TraceContext> context_;
};

// Holds the image tree of one receiver. It is independent of the PathTracer that made it.
class ReceiverTracer {
 public:
  Paths trace(const Transmitter& transmitter) const;
  // Edges lit by the transmitter, computed once for all elements of one array.
  std::shared_ptr<const LitEdges> lit_by(const Transmitter& transmitter) const;
  Paths trace(const Transmitter& transmitter, const LitEdges* lit) const;

  // Derivatives of every path by every parameter. `paths`: the result of trace(transmitter). An
  // Error when a parameter does not exist or has no derivative; never a silent zero.
  Expected<PathDerivatives> differentiate(const Transmitter& transmitter,
                                          const Paths& paths,
                                          std::span<const Parameter> parameters) const;

  const Receiver& receiver() const { return receiver_; }
  const ImageTree& tree() const { return *tree_; }

 private:
  friend class PathTracer;
  ReceiverTracer(std::shared_ptr<const TraceContext> context,
                 Receiver receiver,
                 std::shared_ptr<const ImageTree> tree,
                 std::size_t root);

  std::shared_ptr<const TraceContext> context_;
  Receiver receiver_;
  std::shared_ptr<const ImageTree> tree_;
  std::size_t root_;                           // of the tree
  std::shared_ptr<const LitEdges> lit_edges_;  // only with diffraction
};

}  // namespace rayloc
