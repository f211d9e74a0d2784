// ScatteringEnd: one device of a link past a body, and the rays between it and the body.
//
// A ray leads over a chain of mirrors to a point of the body's axis. The point depends on the
// other end's ray (scattering.h), so chains are found for the whole height and each ray is
// tested at its point.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <cstdint>
#include <memory>
#include <numbers>
#include <vector>

#include "engine/trace/evaluate_path.h"
#include "engine/trace/images/image_tree.h"
#include "engine/trace/interaction_finder.h"
#include "engine/trace/radio_device.h"
#include "engine/trace/scattering/target_body.h"
#include "engine/trace/trace_context.h"

namespace rayloc {

// Chains with one image of the device: one over several surfaces of the same planes.
struct MirrorChains {
  Vec3d image;                        // of the device, as seen from the body
  std::vector<SpecularChain> chains;  // the surfaces, from the device on; points are scratch
};

// The wave that arrives at the body, seen from it, or by reciprocity the one that leaves it.
template <typename T>
struct BodyRay {
  // Field along theta^ and phi^ of `away`, relative to the line-of-sight field of an
  // isotropic antenna.
  Complex<T> theta, phi;
  Vec3<T> away;     // unit, from the body towards the incoming ray
  Vec3<T> arrival;  // unit, direction of travel of a wave from the body at the device
};

class ScatteringEnd {
 public:
  ScatteringEnd(std::shared_ptr<const TraceContext> context, const RadioDevice& device);

  const RadioDevice& device() const { return device_; }

  // All chains that reach one of `heights` above the position, fewest mirrors first.
  std::vector<MirrorChains> chains_to(const TargetPosition& position,
                                      std::span<const double> heights) const;

  // Finds the interactions of the ray to `point`, starting there; false when there is none. The
  // first valid chain applies (opaque surfaces, hard edges); else MirrorChains has only one.
  bool find(MirrorChains& chains,
            const Vec3d& point,
            InteractionFinder& finder,
            std::vector<Interaction>& interactions) const;

  // The ray that find() returned.
  template <typename T>
  BodyRay<T> evaluate(std::span<const Interaction> interactions, const Vec3<T>& point) const;

 private:
  bool retrace(SpecularChain& chain, const Vec3d& point) const;
  bool is_clear(const SpecularChain& chain, const Vec3d& point) const;

  std::shared_ptr<const TraceContext> context_;
  RadioDevice device_;
  LinkEnd<double> end_;
  ImageTree tree_;
};

template <typename T>
Vec3<T> constant(const Vec3d& v) {
  return {T(v.x), T(v.y), T(v.z)};
}

template <typename T>
BodyRay<T> ScatteringEnd::evaluate(std::span<const Interaction> interactions,
                                   const Vec3<T>& point) const {
  const Mat3d& turn = end_.world_from_antenna;
  const LinkEnd<T> device{constant<T>(end_.position),
                          end_.pattern,
                          end_.polarization,
                          {constant<T>(turn.row0), constant<T>(turn.row1), constant<T>(turn.row2)}};
  const auto facet_of = [this](std::uint32_t surface) {
    const Facet<double>& facet = context_->facets[surface];
    return Facet<T>{{constant<T>(facet.plane.normal), T(facet.plane.offset)},
                    {T(facet.relative_permittivity.re), T(facet.relative_permittivity.im)},
                    T(facet.thickness),
                    {},
                    facet.table};
  };
  // An isotropic probe in each polarisation replaces the body.
  const auto probed = [&](Polarization polarization) {
    const LinkEnd<T> probe{point, AntennaPattern::kIsotropic, polarization, {}};
    return evaluate_path<T>(*context_, interactions, facet_of, probe, device);
  };
  const PathCoefficient<T> theta = probed(Polarization::kVertical);
  const PathCoefficient<T> phi = probed(Polarization::kHorizontal);
  const T scale = T(4.0 * std::numbers::pi / context_->wavelength) * theta.length;
  return {{scale * theta.a.re, scale * theta.a.im},
          {scale * phi.a.re, scale * phi.a.im},
          theta.departure,
          theta.arrival};
}

}  // namespace rayloc
