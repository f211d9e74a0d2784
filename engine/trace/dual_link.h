// A link in dual numbers: its ends and its facets, with derivatives by a block of parameters.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include <ceres/jet.h>

#include "engine/base/constants.h"
#include "engine/trace/field_calculator.h"
#include "engine/trace/parameter.h"
#include "engine/trace/radio_device.h"
#include "engine/trace/trace_context.h"

namespace rayloc {

template <int N>
using Dual = ceres::Jet<double, N>;

template <int N>
Vec3<Dual<N>> dual_constant(const Vec3d& v) {
  return {Dual<N>(v.x), Dual<N>(v.y), Dual<N>(v.z)};
}

// Parameters that are varied together, one lane of the dual numbers for each.
template <int N>
struct ParameterBlock {
  std::array<const Parameter*, static_cast<std::size_t>(N)> parameters{};
  int size = 0;

  // Adds `slope` to the derivative by the parameter of that kind, index and axis.
  void seed(
      Dual<N>& value, Parameter::Kind kind, std::uint32_t index, int axis, double slope) const {
    for (int lane = 0; lane < size; ++lane) {
      if (*parameters[static_cast<std::size_t>(lane)] == Parameter{kind, index, axis}) {
        value.v[lane] += slope;
      }
    }
  }
  // True if any parameter of the material varies.
  bool varies(std::uint32_t material) const {
    return std::any_of(parameters.begin(), parameters.begin() + size, [&](const Parameter* p) {
      return p->kind >= Parameter::Kind::kRelativePermittivity && p->index == material;
    });
  }
  // True if a parameter of the material's slab varies.
  bool varies_material(std::uint32_t material) const {
    return std::any_of(parameters.begin(), parameters.begin() + size, [&](const Parameter* p) {
      return p->kind >= Parameter::Kind::kRelativePermittivity &&
             p->kind <= Parameter::Kind::kThickness && p->index == material;
    });
  }
  void seed(Vec3<Dual<N>>& value, Parameter::Kind kind, std::uint32_t index) const {
    seed(value.x, kind, index, 0, 1.0);
    seed(value.y, kind, index, 1, 1.0);
    seed(value.z, kind, index, 2, 1.0);
  }
};

struct EndKinds {
  Parameter::Kind position;
  Parameter::Kind orientation;
  Parameter::Kind array_turn;
};
// Parameters that move a transmitter, in the order of parameter.h.
inline constexpr EndKinds kTransmitterKinds{Parameter::Kind::kTransmitterPosition,
                                            Parameter::Kind::kTransmitterOrientation,
                                            Parameter::Kind::kTransmitterArrayTurn};
// Parameters that move a receiver, in the order of parameter.h.
inline constexpr EndKinds kReceiverKinds{Parameter::Kind::kReceiverPosition,
                                         Parameter::Kind::kReceiverOrientation,
                                         Parameter::Kind::kReceiverArrayTurn};

template <int N>
LinkEnd<Dual<N>> dual_end(const RadioDevice& device,
                          const EndKinds& kinds,
                          const ParameterBlock<N>& block) {
  const Orientation& o = device.orientation;
  Vec3<Dual<N>> array_turn{Dual<N>(o.yaw), Dual<N>(o.pitch), Dual<N>(o.roll)};
  block.seed(array_turn, kinds.array_turn, 0);
  Vec3<Dual<N>> turn = array_turn;
  block.seed(turn, kinds.orientation, 0);

  LinkEnd<Dual<N>> end;
  end.pattern = device.pattern;
  end.polarization = device.polarization;
  end.world_from_antenna = rotation_from_yaw_pitch_roll(turn.x, turn.y, turn.z);
  const Vec3d origin = device.position - rotation(o) * device.lever;
  end.position = dual_constant<N>(origin) +
                 rotation_from_yaw_pitch_roll(array_turn.x, array_turn.y, array_turn.z) *
                     dual_constant<N>(device.lever);
  block.seed(end.position, kinds.position, 0);
  return end;
}

// R of a material: sqrt(1 - S^2).
template <int N>
Dual<N> dual_specular(const TraceContext& context,
                      std::uint32_t material,
                      const ParameterBlock<N>& block) {
  const SurfaceScattering& rough = context.scene->materials()[material].scattering;
  if (!context.options.diffuse || !rough.is_rough()) {
    return Dual<N>(1.0);
  }
  if (rough.scattering_coefficient == 1.0) {  // a root has no slope there; R is 0 all around
    return Dual<N>(0.0);
  }
  Dual<N> scattering(rough.scattering_coefficient);
  block.seed(scattering, Parameter::Kind::kScatteringCoefficient, material, 0, 1.0);
  return sqrt(Dual<N>(1.0) - scattering * scattering);
}

template <int N>
Facet<Dual<N>> dual_facet(const TraceContext& context,
                          std::uint32_t surface,
                          const ParameterBlock<N>& block) {
  const Facet<double>& facet = context.facets[surface];
  const std::uint32_t object = context.scene->owner(surface).object;
  const std::uint32_t material = context.scene->objects()[object].material;
  const Vec3d& normal = facet.plane.normal;

  Facet<Dual<N>> dual;
  block.seed(dual.shift, Parameter::Kind::kObjectTranslation, object);
  Dual<N> offset(0.0);
  block.seed(offset, Parameter::Kind::kSurfaceOffset, surface, 0, 1.0);
  dual.shift = dual.shift + offset * dual_constant<N>(normal);
  dual.plane.normal = dual_constant<N>(normal);
  dual.plane.offset = Dual<N>(facet.plane.offset) + dot(dual.shift, dual.plane.normal);

  const double omega = 2.0 * std::numbers::pi * context.scene->carrier_hz();
  dual.relative_permittivity = {Dual<N>(facet.relative_permittivity.re),
                                Dual<N>(facet.relative_permittivity.im)};
  block.seed(
      dual.relative_permittivity.re, Parameter::Kind::kRelativePermittivity, material, 0, 1.0);
  block.seed(dual.relative_permittivity.im,
             Parameter::Kind::kConductivity,
             material,
             0,
             -1.0 / (omega * kVacuumPermittivity));
  dual.thickness = Dual<N>(facet.thickness);
  block.seed(dual.thickness, Parameter::Kind::kThickness, material, 0, 1.0);
  dual.specular = dual_specular<N>(context, material, block);
  dual.table = block.varies_material(material) ? nullptr : facet.table;
  return dual;
}

}  // namespace rayloc
