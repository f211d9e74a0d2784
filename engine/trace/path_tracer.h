// PathTracer: the paths of a link: line of sight and specular reflections, exactly.
//
//   PathTracer tracer(scene);
//   Paths paths = tracer.trace(transmitter, receiver);
//
//   ReceiverTracer at_ap = tracer.at(receiver);   // image tree built once ...
//   for (...) h = at_ap.trace(transmitter).cfr(grid);  // ... and used for every position
//
// The result of a link depends on the scene and its two ends alone.
// Thread safety: const members may be used from many threads.
#pragma once

#include <memory>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/trace/field_calculator.h"
#include "engine/trace/image_tree.h"
#include "engine/trace/paths.h"
#include "engine/trace/radio_device.h"

namespace rayloc {

class ReceiverTracer;

class PathTracer {
 public:
  // REQUIRES: scene != nullptr, options.max_depth >= 0. The carrier is that of the scene.
  explicit PathTracer(std::shared_ptr<const Scene> scene, const TraceOptions& options = {});

  // Builds an image tree at the receiver for this one link; use at() for many.
  Paths trace(const Transmitter& transmitter, const Receiver& receiver) const;

  // A tracer for everything that this receiver may hear.
  ReceiverTracer at(const Receiver& receiver) const;

  const Scene& scene() const { return *scene_; }
  const TraceOptions& options() const { return options_; }
  double wavelength() const { return wavelength_; }  // [m]

 private:
  friend class ReceiverTracer;

  std::shared_ptr<const Scene> scene_;
  TraceOptions options_;
  double wavelength_;
  // Of each surface, shared with every ReceiverTracer.
  std::shared_ptr<const std::vector<Reflector<double>>> reflectors_;
};

// Holds the image tree of one receiver. Independent of the PathTracer that made it.
class ReceiverTracer {
 public:
  Paths trace(const Transmitter& transmitter) const;

  const Receiver& receiver() const { return receiver_; }
  const ImageTree& tree() const { return tree_; }

 private:
  friend class PathTracer;
  ReceiverTracer(const PathTracer& tracer, const Receiver& receiver);

  Path evaluate(const Transmitter& transmitter, const SpecularChain& chain) const;

  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const std::vector<Reflector<double>>> reflectors_;
  double wavelength_;
  Receiver receiver_;
  LinkEnd<double> receiver_end_;
  ImageTree tree_;
};

}  // namespace rayloc
