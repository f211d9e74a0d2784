// TracedLink: an array, a device and a scene that can be changed by a Parameter and traced again:
// the reference for derivatives.
#pragma once

#include <complex>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/trace/path_tracer.h"

namespace rayloc::test {

using Csi = std::vector<std::complex<double>>;

class TracedLink {
 public:
  TracedLink(Scene::Input input,
             std::vector<Transmitter> transmitters,
             std::vector<Receiver> receivers,
             const TraceOptions& options);

  // "box" (six walls and a cupboard in the line of sight), "meeting_room", "corridor": an array of
  // three tilted elements, a tilted device whose antenna is not at its origin, and a free-standing
  // screen.
  static TracedLink of(const std::string& scene, const TraceOptions& options);

  // The same link with one parameter changed by `by`.
  TracedLink changed(const Parameter& parameter, double by) const;

  const TraceOptions& options() const { return options_; }
  const std::shared_ptr<const Scene>& shared_scene() const { return scene_; }
  const Scene& scene() const { return *scene_; }
  const std::vector<Transmitter>& transmitters() const { return transmitters_; }
  const std::vector<Receiver>& receivers() const { return receivers_; }
  const OfdmGrid& grid() const { return grid_; }
  // Order: transmitters, receivers, tones; tones vary fastest.
  Csi csi() const;
  // csi() with the receiver at another position.
  Csi reference() const;
  // The surfaces of every path of every pair.
  std::vector<std::uint32_t> path_keys() const;
  // All parameters of the link's channel; of objects only those with the most paths.
  std::vector<Parameter> parameters() const;
  std::string name_of(const Parameter& parameter) const;

  // d csi() / d parameter, computed by the engine.
  Csi csi_derivative(const Parameter& parameter) const;
  // Gradient of a loss L, by the engine; `adjoint` returns g with dL = Re sum conj(g) dh.
  std::vector<double> gradient(const std::vector<Parameter>& parameters,
                               const std::function<Csi(const Csi&)>& adjoint) const;

 private:
  void for_each_pair(const std::function<void(const Transmitter&, const ReceiverTracer&)>&) const;
  void change_scene(const Parameter& parameter, double by);

  Scene::Input input_;
  std::vector<Transmitter> transmitters_;
  std::vector<Receiver> receivers_;
  TraceOptions options_;
  double gain_ = 1.0;
  std::shared_ptr<const Scene> scene_;
  OfdmGrid grid_;
};

// A step for central differences of fourth order.
double difference_step(const Parameter& parameter);

}  // namespace rayloc::test
