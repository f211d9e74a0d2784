#include "engine/trace/scattering/scattering.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <ceres/jet.h>

#include "engine/base/check.h"
#include "engine/base/constants.h"
#include "engine/trace/scattering/scattering_end.h"
#include "engine/trace/scattering/scattering_pair.h"
#include "engine/trace/trace_context.h"

namespace rayloc {
namespace {

using PlaceDual = ceres::Jet<double, 2>;

// Largest gain of a body, relative to a mirror at its position; above that of any material tested.
constexpr double kLargestGain = 4.0;

double size(const BodyRay<double>& ray) { return std::sqrt(abs2(ray.theta) + abs2(ray.phi)); }

// The centres of equal parts of the body's height.
std::vector<double> sample_heights(const CylinderBody& body, double step) {
  const int count = std::max(1, static_cast<int>(std::ceil(body.height / step)));
  std::vector<double> heights;
  heights.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    heights.push_back(body.base + body.height * (i + 0.5) / count);
  }
  return heights;
}

Error not_usable(const std::string& what, double value, const std::string& wanted) {
  return {ErrorKind::kBadInput, what + " is " + std::to_string(value) + ", must be " + wanted};
}

}  // namespace

struct ScatteringContext {
  std::shared_ptr<const TraceContext> context;
  CylinderScatterer scatterer;
  ScatteringOptions options;
  std::vector<double> heights;
};

class TargetLink::Impl {
 public:
  Impl(std::shared_ptr<const ScatteringContext> shared,
       std::shared_ptr<const ScatteringEnd> transmitter,
       const Receiver& receiver)
      : shared_(std::move(shared)),
        transmitter_(std::move(transmitter)),
        receiver_(shared_->context, receiver) {
    const double distance = norm(receiver.position - transmitter_->device().position);
    // For both ends at one position the direct amplitude is infinite.
    threshold_ = distance > 0.0 ? shared_->options.negligible / distance : 0.0;
  }

  Expected<TargetPaths> trace(const TargetPosition& position, bool differentiate) const;

 private:
  // A pair that is not negligible, with all data for its derivatives.
  struct Pair {
    ScatteringPlace<double> place;
    std::vector<Interaction> in;   // from the body on
    std::vector<Interaction> out;  // from the body on
    Path path;
  };

  Expected<void> check(const TargetPosition& position) const;
  std::vector<Pair> find(const TargetPosition& position) const;
  bool evaluate(Pair& pair, const Vec3d& point, const CylinderRoute<double>& route) const;
  ScatteredCoefficient<PlaceDual> differentiate(const Pair& pair) const;

  std::shared_ptr<const ScatteringContext> shared_;
  std::shared_ptr<const ScatteringEnd> transmitter_;
  ScatteringEnd receiver_;
  double threshold_ = 0.0;  // of field over length [1/m]
};

Expected<void> TargetLink::Impl::check(const TargetPosition& position) const {
  if (!std::isfinite(position.x) || !std::isfinite(position.y)) {
    return tl::make_unexpected(not_usable(
        "body: its position", std::isfinite(position.x) ? position.y : position.x, "finite [m]"));
  }
  const auto inside = [&](const RadioDevice& device) {
    return shared_->scatterer.contains(device.position - Vec3d{position.x, position.y, 0.0});
  };
  for (const auto& [device, name] :
       {std::pair{&transmitter_->device(), "transmitter"}, {&receiver_.device(), "receiver"}}) {
    if (inside(*device)) {
      return bad_input("body at (" + std::to_string(position.x) + ", " +
                       std::to_string(position.y) + "): the " + name +
                       " is inside it; move the body or make it smaller");
    }
  }
  return {};
}

// Every pair of chains whose rays exist and are not negligible, in canonical order.
std::vector<TargetLink::Impl::Pair> TargetLink::Impl::find(const TargetPosition& position) const {
  const CylinderScatterer& scatterer = shared_->scatterer;
  const auto max_depth = static_cast<std::size_t>(shared_->options.trace.max_depth);
  auto in = transmitter_->chains_to(position, shared_->heights);
  auto out = receiver_.chains_to(position, shared_->heights);
  InteractionFinder finder(shared_->context);
  std::vector<Pair> pairs;
  Pair pair;
  for (MirrorChains& from : in) {
    for (MirrorChains& to : out) {
      if (from.chains.front().surfaces.size() + to.chains.front().surfaces.size() > max_depth) {
        break;  // fewest mirrors come first
      }
      pair.place = {from.image, to.image, position.x, position.y};
      const CylinderRoute<double> route = pair.place.route(scatterer);
      if (!(scatterer.validity(route) > 0.0)) {
        continue;
      }
      const Vec3d point{position.x, position.y, limited_height(route.height, scatterer.body())};
      if (transmitter_->find(from, point, finder, pair.in) &&
          receiver_.find(to, point, finder, pair.out) && evaluate(pair, point, route)) {
        pairs.push_back(pair);
      }
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return a.path.interactions.size() < b.path.interactions.size();
  });
  return pairs;
}

// False when the pair is left out.
bool TargetLink::Impl::evaluate(Pair& pair,
                                const Vec3d& point,
                                const CylinderRoute<double>& route) const {
  const bool soft = shared_->options.trace.softness > 0.0;
  const auto max_depth = static_cast<std::size_t>(shared_->options.trace.max_depth);
  if (!soft && pair.in.size() + pair.out.size() > max_depth) {
    return false;
  }
  const BodyRay<double> in = transmitter_->evaluate<double>(pair.in, point);
  const BodyRay<double> out = receiver_.evaluate<double>(pair.out, point);
  if (!(kLargestGain * size(in) * size(out) > threshold_ * route.length)) {
    return false;
  }
  const auto coefficient = scattered(shared_->scatterer, route, in, out);
  pair.path = {coefficient.a,
               coefficient.length / kSpeedOfLight,
               -in.arrival,
               -out.arrival,
               {pair.in.rbegin(), pair.in.rend()}};
  pair.path.interactions.insert(pair.path.interactions.end(), pair.out.begin(), pair.out.end());
  return true;
}

ScatteredCoefficient<PlaceDual> TargetLink::Impl::differentiate(const Pair& pair) const {
  const ScatteringPlace<PlaceDual> place{pair.place.source,
                                         pair.place.observer,
                                         PlaceDual(pair.place.x, 0),
                                         PlaceDual(pair.place.y, 1)};
  const CylinderRoute<PlaceDual> route = place.route(shared_->scatterer);
  const Vec3<PlaceDual> point{
      place.x, place.y, limited_height(route.height, shared_->scatterer.body())};
  return scattered(shared_->scatterer,
                   route,
                   transmitter_->evaluate<PlaceDual>(pair.in, point),
                   receiver_.evaluate<PlaceDual>(pair.out, point));
}

Expected<TargetPaths> TargetLink::Impl::trace(const TargetPosition& position,
                                              bool with_derivatives) const {
  RAYLOC_TRY(check(position));
  std::vector<Pair> pairs = find(position);
  TargetPaths result;
  if (with_derivatives) {
    result.by_position = PathDerivatives(pairs.size(), 2);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const ScatteredCoefficient<PlaceDual> dual = differentiate(pairs[i]);
      for (int axis = 0; axis < 2; ++axis) {
        result.by_position.at(i, static_cast<std::size_t>(axis)) = {
            {dual.a.re.v[axis], dual.a.im.v[axis]}, dual.length.v[axis] / kSpeedOfLight};
      }
    }
  }
  std::vector<Path> paths;
  paths.reserve(pairs.size());
  for (Pair& pair : pairs) {
    paths.push_back(std::move(pair.path));
  }
  result.paths = Paths(std::move(paths));
  return result;
}

Expected<Paths> TargetLink::trace(const TargetPosition& position) const {
  auto traced = impl_->trace(position, false);
  RAYLOC_TRY(traced);
  return std::move(traced->paths);
}

Expected<TargetPaths> TargetLink::differentiate(const TargetPosition& position) const {
  return impl_->trace(position, true);
}

Expected<TargetTracer> TargetTracer::create(std::shared_ptr<const Scene> scene,
                                            const TargetBody& body,
                                            const ScatteringOptions& options) {
  RAYLOC_CHECK(scene != nullptr);
  if (!(std::isfinite(options.negligible) && options.negligible >= 0.0)) {
    return tl::make_unexpected(
        not_usable("scattering: negligible", options.negligible, "0 or more"));
  }
  if (options.trace.max_depth < 0) {
    return tl::make_unexpected(
        not_usable("scattering: trace.max_depth", options.trace.max_depth, "0 or more"));
  }
  if (!(std::isfinite(options.trace.softness) && options.trace.softness >= 0.0)) {
    return tl::make_unexpected(
        not_usable("scattering: trace.softness", options.trace.softness, "0 or more [m]"));
  }
  if (!(std::isfinite(options.height_step) && options.height_step > 0.0)) {
    return tl::make_unexpected(
        not_usable("scattering: height_step", options.height_step, "more than 0 [m]"));
  }
  auto scatterer = make_scatterer(body, scene->carrier_hz());
  RAYLOC_TRY(scatterer);
  auto context = std::make_shared<const TraceContext>(std::move(scene), options.trace);
  auto heights = sample_heights(scatterer->body(), options.height_step);
  return TargetTracer(std::make_shared<const ScatteringContext>(
      ScatteringContext{std::move(context), std::move(*scatterer), options, std::move(heights)}));
}

TargetLink TargetTracer::link(const Transmitter& transmitter, const Receiver& receiver) const {
  return links(transmitter, std::span(&receiver, 1)).front();
}

std::vector<TargetLink> TargetTracer::links(const Transmitter& transmitter,
                                            std::span<const Receiver> receivers) const {
  const auto end = std::make_shared<const ScatteringEnd>(shared_->context, transmitter);
  std::vector<TargetLink> links;
  for (const Receiver& receiver : receivers) {
    links.push_back(TargetLink(std::make_shared<const TargetLink::Impl>(shared_, end, receiver)));
  }
  return links;
}

}  // namespace rayloc
