#include "engine/trace/path_tracer.h"

#include <algorithm>
#include <utility>

#include "engine/base/check.h"
#include "engine/base/constants.h"
#include "engine/em/spherical.h"

namespace rayloc {
namespace {

LinkEnd<double> link_end(const RadioDevice& device) {
  return {device.pattern, device.polarization, rotation(device.orientation)};
}

bool canonical_order(const Path& a, const Path& b) {
  if (a.interactions.size() != b.interactions.size()) {
    return a.interactions.size() < b.interactions.size();
  }
  return std::lexicographical_compare(
      a.interactions.begin(),
      a.interactions.end(),
      b.interactions.begin(),
      b.interactions.end(),
      [](const Interaction& x, const Interaction& y) { return x.surface < y.surface; });
}

}  // namespace

PathTracer::PathTracer(std::shared_ptr<const Scene> scene, const TraceOptions& options)
    : scene_(std::move(scene)), options_(options) {
  RAYLOC_CHECK(scene_ != nullptr && options.max_depth >= 0);
  wavelength_ = kSpeedOfLight / scene_->carrier_hz();
  std::vector<Reflector<double>> reflectors;
  reflectors.reserve(scene_->surfaces().size());
  for (std::uint32_t i = 0; i < scene_->surfaces().size(); ++i) {
    const RadioMaterial& material = scene_->material_of(i);
    reflectors.push_back({scene_->surfaces()[i].plane().normal,
                          complex_permittivity(material, scene_->carrier_hz()),
                          material.thickness});
  }
  reflectors_ = std::make_shared<const std::vector<Reflector<double>>>(std::move(reflectors));
}

Paths PathTracer::trace(const Transmitter& transmitter, const Receiver& receiver) const {
  return at(receiver).trace(transmitter);
}

ReceiverTracer PathTracer::at(const Receiver& receiver) const { return {*this, receiver}; }

ReceiverTracer::ReceiverTracer(const PathTracer& tracer, const Receiver& receiver)
    : scene_(tracer.scene_),
      reflectors_(tracer.reflectors_),
      wavelength_(tracer.wavelength_),
      receiver_(receiver),
      receiver_end_(link_end(receiver)),
      tree_(*scene_, receiver.position, tracer.options_) {}

Paths ReceiverTracer::trace(const Transmitter& transmitter) const {
  std::vector<SpecularChain> chains;
  const std::size_t count = tree_.chains_to(transmitter.position, chains);
  std::vector<Path> paths;
  paths.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    paths.push_back(evaluate(transmitter, chains[i]));
  }
  std::sort(paths.begin(), paths.end(), canonical_order);
  return Paths(std::move(paths));
}

Path ReceiverTracer::evaluate(const Transmitter& transmitter, const SpecularChain& chain) const {
  Path path;
  // The chain starts at the receiver, the path at the transmitter.
  std::vector<Vec3d> vertices{transmitter.position};
  std::vector<Reflector<double>> reflectors;
  for (std::size_t i = chain.surfaces.size(); i > 0; --i) {
    const std::uint32_t surface = chain.surfaces[i - 1];
    vertices.push_back(chain.points[i - 1]);
    reflectors.push_back((*reflectors_)[surface]);
    path.interactions.push_back({InteractionKind::kReflection,
                                 scene_->owner(surface).object,
                                 surface,
                                 chain.points[i - 1]});
  }
  vertices.push_back(receiver_.position);

  const PathCoefficient<double> coefficient = path_coefficient<double>(
      vertices, reflectors, link_end(transmitter), receiver_end_, wavelength_);
  path.a = coefficient.a;
  path.tau = coefficient.length / kSpeedOfLight;
  const SphericalAngles departure = spherical_angles(vertices[1] - vertices[0]);
  const SphericalAngles arrival = spherical_angles(vertices[vertices.size() - 2] - vertices.back());
  path.theta_t = departure.theta;
  path.phi_t = departure.phi;
  path.theta_r = arrival.theta;
  path.phi_r = arrival.phi;
  return path;
}

}  // namespace rayloc
