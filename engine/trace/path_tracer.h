// PathTracer: the paths of a link: line of sight, specular reflections and, on request, straight
// transmission through objects, exactly.
//
//   PathTracer tracer(scene);
//   Paths paths = tracer.trace(transmitter, receiver);
//
//   ReceiverTracer at_ap = tracer.at(receiver);   // image tree built once ...
//   for (...) h = at_ap.trace(transmitter).cfr(grid);  // ... and used for every position
//
// The result of a link depends on the scene, the options and its two ends alone; where shot rays
// propose (TraceOptions::candidates), also on how the processor rounds for rays that graze an edge.
// Thread safety: const members may be used from many threads.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/expected.h"
#include "engine/scene/scene.h"
#include "engine/trace/images/image_tree.h"
#include "engine/trace/parameter.h"
#include "engine/trace/path_derivatives.h"
#include "engine/trace/paths.h"
#include "engine/trace/radio_device.h"
#include "engine/trace/trace_context.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

class ReceiverTracer;

class PathTracer {
 public:
  // REQUIRES: scene != nullptr, options.max_depth >= 0, options.softness finite and >= 0. The
  // carrier is that of the scene.
  explicit PathTracer(std::shared_ptr<const Scene> scene, const TraceOptions& options = {});

  // Builds an image tree at the receiver for this one link; use at() for many.
  Paths trace(const Transmitter& transmitter, const Receiver& receiver) const;

  // A tracer for everything that this receiver may hear.
  ReceiverTracer at(const Receiver& receiver) const;
  // The same for several, such as the elements of an array; those so near to each other that they
  // see about the same share an image tree. What each hears is what it hears alone.
  std::vector<ReceiverTracer> at(std::span<const Receiver> receivers) const;

  const Scene& scene() const { return *context_->scene; }
  const TraceOptions& options() const { return context_->options; }
  double wavelength() const { return context_->wavelength; }  // [m]

 private:
  std::shared_ptr<const TraceContext> context_;
};

// Holds the image tree of one receiver. Independent of the PathTracer that made it.
class ReceiverTracer {
 public:
  Paths trace(const Transmitter& transmitter) const;

  // Derivatives of every path by every parameter. `paths`: what trace(transmitter) gave. An Error
  // when a parameter does not exist or has no derivative; never zero in silence.
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
                 std::size_t root)
      : context_(std::move(context)),
        receiver_(std::move(receiver)),
        tree_(std::move(tree)),
        root_(root) {}

  std::shared_ptr<const TraceContext> context_;
  Receiver receiver_;
  std::shared_ptr<const ImageTree> tree_;
  std::size_t root_;  // of the tree
};

}  // namespace rayloc
