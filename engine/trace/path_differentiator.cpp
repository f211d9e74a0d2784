#include "engine/trace/path_differentiator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <ceres/jet.h>

#include "engine/base/constants.h"
#include "engine/trace/evaluate_path.h"

namespace rayloc {
namespace {

using Kind = Parameter::Kind;

template <int N>
using Dual = ceres::Jet<double, N>;

template <int N>
Vec3<Dual<N>> constant(const Vec3d& v) {
  return {Dual<N>(v.x), Dual<N>(v.y), Dual<N>(v.z)};
}

// Parameters that are varied together, each by a lane of the dual numbers.
template <int N>
struct Block {
  std::array<const Parameter*, static_cast<std::size_t>(N)> parameters{};
  int size = 0;

  // Unit derivative by a parameter of that kind, index and axis.
  void seed(Dual<N>& value, Kind kind, std::uint32_t index, int axis, double slope) const {
    for (int lane = 0; lane < size; ++lane) {
      if (*parameters[static_cast<std::size_t>(lane)] == Parameter{kind, index, axis}) {
        value.v[lane] += slope;
      }
    }
  }
  bool varies_material(std::uint32_t material) const {
    return std::any_of(parameters.begin(), parameters.begin() + size, [&](const Parameter* p) {
      return p->kind >= Kind::kRelativePermittivity && p->index == material;
    });
  }
  void seed(Vec3<Dual<N>>& value, Kind kind, std::uint32_t index) const {
    seed(value.x, kind, index, 0, 1.0);
    seed(value.y, kind, index, 1, 1.0);
    seed(value.z, kind, index, 2, 1.0);
  }
};

struct EndKinds {
  Kind position;
  Kind orientation;
  Kind array_turn;
};
// The parameters that move a transmitter, as parameter.h orders them.
constexpr EndKinds kTransmitterKinds{
    Kind::kTransmitterPosition, Kind::kTransmitterOrientation, Kind::kTransmitterArrayTurn};
// The parameters that move a receiver, as parameter.h orders them.
constexpr EndKinds kReceiverKinds{
    Kind::kReceiverPosition, Kind::kReceiverOrientation, Kind::kReceiverArrayTurn};

template <int N>
LinkEnd<Dual<N>> dual_end(const RadioDevice& device, const EndKinds& kinds, const Block<N>& block) {
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
  end.position =
      constant<N>(origin) + rotation_from_yaw_pitch_roll(array_turn.x, array_turn.y, array_turn.z) *
                                constant<N>(device.lever);
  block.seed(end.position, kinds.position, 0);
  return end;
}

template <int N>
Facet<Dual<N>> dual_facet(const TraceContext& context,
                          std::uint32_t surface,
                          const Block<N>& block) {
  const Facet<double>& facet = context.facets[surface];
  const std::uint32_t object = context.scene->owner(surface).object;
  const std::uint32_t material = context.scene->objects()[object].material;
  const Vec3d& normal = facet.plane.normal;

  Facet<Dual<N>> dual;
  block.seed(dual.shift, Kind::kObjectTranslation, object);
  Dual<N> offset(0.0);
  block.seed(offset, Kind::kSurfaceOffset, surface, 0, 1.0);
  dual.shift = dual.shift + offset * constant<N>(normal);
  dual.plane.normal = constant<N>(normal);
  dual.plane.offset = Dual<N>(facet.plane.offset) + dot(dual.shift, dual.plane.normal);

  const double omega = 2.0 * std::numbers::pi * context.scene->carrier_hz();
  dual.relative_permittivity = {Dual<N>(facet.relative_permittivity.re),
                                Dual<N>(facet.relative_permittivity.im)};
  block.seed(dual.relative_permittivity.re, Kind::kRelativePermittivity, material, 0, 1.0);
  block.seed(dual.relative_permittivity.im,
             Kind::kConductivity,
             material,
             0,
             -1.0 / (omega * kVacuumPermittivity));
  dual.thickness = Dual<N>(facet.thickness);
  block.seed(dual.thickness, Kind::kThickness, material, 0, 1.0);
  dual.table = block.varies_material(material) ? nullptr : facet.table;
  return dual;
}

// The derivatives of `path` by the parameters of a block.
template <int N>
class BlockEvaluator {
 public:
  BlockEvaluator(const TraceContext& context,
                 const RadioDevice& transmitter,
                 const RadioDevice& receiver)
      : context_(context), transmitter_(transmitter), receiver_(receiver) {}

  PathCoefficient<Dual<N>> evaluate(const Path& path, const Block<N>& block) {
    if (block.parameters != last_.parameters || last_.size == 0) {
      last_ = block;  // neighbouring paths mostly share their blocks
      transmitter_end_ = dual_end<N>(transmitter_, kTransmitterKinds, block);
      receiver_end_ = dual_end<N>(receiver_, kReceiverKinds, block);
    }
    return evaluate_path<Dual<N>>(
        context_,
        path.interactions,
        [&](std::uint32_t surface) { return dual_facet<N>(context_, surface, block); },
        transmitter_end_,
        receiver_end_);
  }

 private:
  const TraceContext& context_;
  const RadioDevice& transmitter_;
  const RadioDevice& receiver_;
  Block<N> last_;
  LinkEnd<Dual<N>> transmitter_end_;
  LinkEnd<Dual<N>> receiver_end_;
};

}  // namespace

Expected<void> PathDifferentiator::check(const Parameter& parameter) const {
  const Scene& scene = *context_.scene;
  std::size_t count = 1;
  int axes = 3;
  std::string what = "antenna";
  switch (parameter.kind) {
    case Kind::kObjectTranslation:
      count = scene.objects().size();
      what = "object";
      break;
    case Kind::kSurfaceOffset:
      count = scene.surfaces().size();
      axes = 1;
      what = "surface";
      break;
    case Kind::kRelativePermittivity:
    case Kind::kConductivity:
    case Kind::kThickness:
      count = scene.materials().size();
      axes = 1;
      what = "material";
      break;
    case Kind::kTransmitterGain:
    case Kind::kReceiverGain:
      axes = 1;
      break;
    default:
      break;
  }
  if (parameter.index >= count || parameter.axis < 0 || parameter.axis >= axes) {
    return bad_input("no derivative by axis " + std::to_string(parameter.axis) + " of " + what +
                     " " + std::to_string(parameter.index) + ": the scene has " +
                     std::to_string(count) + " of them with " + std::to_string(axes) +
                     (axes == 1 ? " axis" : " axes"));
  }
  if (parameter.kind == Kind::kThickness &&
      std::isinf(scene.materials()[parameter.index].thickness)) {
    return bad_input("no derivative by the thickness of '" +
                     scene.materials()[parameter.index].name +
                     "': it is a half space; give the material a thickness");
  }
  return {};
}

bool PathDifferentiator::depends(const Path& path, const Parameter& parameter) const {
  const Scene& scene = *context_.scene;
  const auto is_meant = [&](std::uint32_t surface) {
    switch (parameter.kind) {
      case Kind::kObjectTranslation:
        return scene.owner(surface).object == parameter.index;
      case Kind::kSurfaceOffset:
        return surface == parameter.index;
      case Kind::kRelativePermittivity:
      case Kind::kConductivity:
      case Kind::kThickness:
        return scene.objects()[scene.owner(surface).object].material == parameter.index;
      default:
        return true;
    }
  };
  const bool by_an_end = parameter.kind < Kind::kObjectTranslation;
  return by_an_end ||
         std::any_of(path.interactions.begin(), path.interactions.end(), [&](const Interaction& i) {
           const auto& covers = context_.covers[i.surface];
           return is_meant(i.surface) || std::any_of(covers.begin(), covers.end(), is_meant);
         });
}

Expected<PathDerivatives> PathDifferentiator::differentiate(
    const Paths& paths, std::span<const Parameter> parameters) const {
  for (const Parameter& parameter : parameters) {
    if (auto valid = check(parameter); !valid) {
      return tl::make_unexpected(valid.error());
    }
  }
  // Two lanes are half the work of four: enough for a position in plan.
  return parameters.size() <= 2 ? run<2>(paths, parameters) : run<4>(paths, parameters);
}

template <int N>
PathDerivatives PathDifferentiator::run(const Paths& paths,
                                        std::span<const Parameter> parameters) const {
  PathDerivatives result(paths.size(), parameters.size());
  BlockEvaluator<N> evaluator(context_, transmitter_, receiver_);
  std::vector<std::size_t> wanted;
  for (std::size_t p = 0; p < paths.size(); ++p) {
    const Path& path = paths[p];
    wanted.clear();
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const Kind kind = parameters[i].kind;
      if (kind == Kind::kTransmitterGain || kind == Kind::kReceiverGain) {
        result.at(p, i) = {path.a, 0.0};  // a is proportional to it
      } else if (depends(path, parameters[i])) {
        wanted.push_back(i);
      }
    }
    for (std::size_t first = 0; first < wanted.size(); first += N) {
      Block<N> block;
      for (std::size_t i = first; i < wanted.size() && i < first + N; ++i) {
        block.parameters[static_cast<std::size_t>(block.size++)] = &parameters[wanted[i]];
      }
      const PathCoefficient<Dual<N>> dual = evaluator.evaluate(path, block);
      for (int lane = 0; lane < block.size; ++lane) {
        result.at(p, wanted[first + static_cast<std::size_t>(lane)]) = {
            {dual.a.re.v[lane], dual.a.im.v[lane]}, dual.length.v[lane] / kSpeedOfLight};
      }
    }
  }
  return result;
}

}  // namespace rayloc
