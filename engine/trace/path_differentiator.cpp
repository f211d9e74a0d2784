#include "engine/trace/path_differentiator.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/base/constants.h"
#include "engine/trace/dual_link.h"
#include "engine/trace/evaluate_path.h"

namespace rayloc {
namespace {

using Kind = Parameter::Kind;

// The derivatives of `path` by the parameters of a block.
template <int N>
class BlockEvaluator {
 public:
  BlockEvaluator(const TraceContext& context,
                 const RadioDevice& transmitter,
                 const RadioDevice& receiver)
      : context_(context), transmitter_(transmitter), receiver_(receiver) {}

  PathCoefficient<Dual<N>> evaluate(const Path& path, const ParameterBlock<N>& block) {
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
  ParameterBlock<N> last_;
  LinkEnd<Dual<N>> transmitter_end_;
  LinkEnd<Dual<N>> receiver_end_;
};

}  // namespace

namespace {

// Checks the kinds of em/surface_scattering.h.
Expected<void> check_scattering(const TraceContext& context, const Parameter& parameter) {
  const RadioMaterial& material = context.scene->materials()[parameter.index];
  const SurfaceScattering& rough = material.scattering;
  const std::string what = "no derivative by the scattering of '" + material.name + "': ";
  if (!context.options.diffuse) {
    return bad_input(what + "it is traced as smooth; ask for diffuse scattering");
  }
  if (!rough.is_rough() || rough.scattering_coefficient == 1.0) {
    return bad_input(what + "its scattering_coefficient must be above 0 and below 1");
  }
  const bool is_lambertian = rough.pattern == ScatteringPattern::kLambertian;
  const bool has_back = rough.pattern == ScatteringPattern::kBackscattering;
  const bool of_back = parameter.kind == Kind::kAlphaBack || parameter.kind == Kind::kLobeShare;
  if ((is_lambertian && parameter.kind == Kind::kAlphaReflected) || (of_back && !has_back)) {
    return bad_input(what + "its scattering_pattern has no such lobe");
  }
  return {};
}

}  // namespace

Expected<void> check_parameter(const TraceContext& context, const Parameter& parameter) {
  const Scene& scene = *context.scene;
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
    case Kind::kScatteringCoefficient:
    case Kind::kXpdCoefficient:
    case Kind::kAlphaReflected:
    case Kind::kAlphaBack:
    case Kind::kLobeShare:
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
  return parameter.kind >= Kind::kScatteringCoefficient ? check_scattering(context, parameter)
                                                        : Expected<void>{};
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
      case Kind::kScatteringCoefficient:
        return scene.objects()[scene.owner(surface).object].material == parameter.index;
      case Kind::kXpdCoefficient:
      case Kind::kAlphaReflected:
      case Kind::kAlphaBack:
      case Kind::kLobeShare:
        return false;  // changes only scattered power, no path
      default:
        return true;
    }
  };
  const bool by_an_end = parameter.kind < Kind::kObjectTranslation;
  return by_an_end ||
         std::any_of(path.interactions.begin(), path.interactions.end(), [&](const Interaction& i) {
           const auto& covers = context_.covers[i.surface];
           const bool at_far_face = is_edge(i.kind) && is_meant(context_.wedges[i.edge].face_n);
           return at_far_face || is_meant(i.surface) ||
                  std::any_of(covers.begin(), covers.end(), is_meant);
         });
}

Expected<PathDerivatives> PathDifferentiator::differentiate(
    const Paths& paths, std::span<const Parameter> parameters) const {
  for (const Parameter& parameter : parameters) {
    RAYLOC_TRY(check_parameter(context_, parameter));
  }
  // Two lanes cost half as much as four: enough for a position in plan.
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
      ParameterBlock<N> block;
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
