#include "engine/trace/diffuse/diffuse_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/base/check.h"
#include "engine/base/constants.h"
#include "engine/trace/diffuse/leg_finder.h"
#include "engine/trace/diffuse/surface_patches.h"
#include "engine/trace/path_differentiator.h"

namespace rayloc {
namespace {

using Kind = Parameter::Kind;

// Barycentric coordinates and weight of a node.
struct TriangleNode {
  std::array<double, 3> share;
  double weight;
};
// Radon's rule, exact to degree 5: a = (6 -+ sqrt 15) / 21, weights (155 -+ sqrt 15) / 1200.
constexpr double kRoot15 = 3.8729833462074170;
constexpr double kRadonNear = (6.0 - kRoot15) / 21.0;       // a ratio of Radon's rule
constexpr double kFar = (6.0 + kRoot15) / 21.0;             // a ratio of Radon's rule
constexpr double kNearWeight = (155.0 - kRoot15) / 1200.0;  // of Radon's rule
constexpr double kFarWeight = (155.0 + kRoot15) / 1200.0;   // of Radon's rule
// Radon's rule of seven nodes.
constexpr std::array<TriangleNode, 7> kRule{
    {{{1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0}, 0.225},
     {{kRadonNear, kRadonNear, 1.0 - 2.0 * kRadonNear}, kNearWeight},
     {{kRadonNear, 1.0 - 2.0 * kRadonNear, kRadonNear}, kNearWeight},
     {{1.0 - 2.0 * kRadonNear, kRadonNear, kRadonNear}, kNearWeight},
     {{kFar, kFar, 1.0 - 2.0 * kFar}, kFarWeight},
     {{kFar, 1.0 - 2.0 * kFar, kFar}, kFarWeight},
     {{1.0 - 2.0 * kFar, kFar, kFar}, kFarWeight}}};

// True if faces would move with the parameter.
bool moves_faces(const Parameter& parameter) {
  return parameter.kind == Kind::kObjectTranslation || parameter.kind == Kind::kSurfaceOffset;
}

// Data of a leg that is reused in many paths.
struct KnownLeg {
  const FoundLeg* found;
  LegToPatch<double> leg;
};

}  // namespace

// State of the computation of one density.
class DiffuseTracer::Integration {
 public:
  Integration(const DiffuseTracer& tracer, const Transmitter& transmitter, const Receiver& receiver)
      : tracer_(tracer),
        context_(*tracer.context_),
        transmitter_(link_end(transmitter)),
        receiver_(link_end(receiver)),
        from_(tracer.context_, transmitter.position, tracer.options_.reflections),
        to_(tracer.context_, receiver.position, tracer.options_.reflections) {}

  DiffuseDensity run() {
    for (std::uint32_t surface = 0; surface < context_.facets.size(); ++surface) {
      if (tracer_.materials_.of_surface(surface) != nullptr) {
        add(surface);
      }
    }
    const auto most = tracer_.options_.most_points;
    while (!pairs_.empty() && error_ > tracer_.options_.tolerance * power_ && points_ < most) {
      std::pop_heap(pairs_.begin(), pairs_.end());
      Pair widest = std::move(pairs_.back());
      pairs_.pop_back();
      error_ -= widest.error;
      for (Cell& half : widest.halves) {
        power_ -= half.power;
        add(std::move(half));
      }
    }
    std::vector<DiffuseEcho> echoes;
    for (const Pair& pair : pairs_) {
      for (const Cell& half : pair.halves) {
        echoes.insert(echoes.end(), half.echoes.begin(), half.echoes.end());
      }
    }
    return {std::move(echoes), std::max(error_, 0.0)};
  }

 private:
  struct Cell {
    SurfaceTriangle triangle;
    std::vector<DiffuseEcho> echoes;
    double power = 0.0;
  };
  // A cell as its halves, and their difference from the whole.
  struct Pair {
    std::array<Cell, 2> halves;
    double error = 0.0;
    friend bool operator<(const Pair& a, const Pair& b) { return a.error < b.error; }
  };

  void add(std::uint32_t surface) {
    // The first cells must be small enough to resolve nearby surfaces and shadows.
    constexpr double kSmallest = 0.5;    // [m], chosen
    constexpr double kOfDistance = 0.5;  // of the distance to the nearer end, chosen
    const auto most_edge = [&](const SurfaceTriangle& triangle) {
      const Vec3d middle = triangle.middle();
      const double nearer =
          std::min(norm(middle - transmitter_.position), norm(middle - receiver_.position));
      return std::max(kSmallest, kOfDistance * nearer);
    };
    std::vector<SurfaceTriangle> pieces;
    for (const SurfaceTriangle& triangle : triangles_of(*context_.scene, surface)) {
      cut(triangle, most_edge, pieces);
    }
    for (const SurfaceTriangle& piece : pieces) {
      add(cell(piece));
    }
  }

  void add(Cell whole) {
    const auto halves = whole.triangle.halves();
    Pair pair{{cell(halves.first), cell(halves.second)}, 0.0};
    const double together = pair.halves[0].power + pair.halves[1].power;
    pair.error = std::abs(whole.power - together);
    error_ += pair.error;
    power_ += together;
    pairs_.push_back(std::move(pair));
    std::push_heap(pairs_.begin(), pairs_.end());
  }

  Cell cell(const SurfaceTriangle& triangle) {
    Cell made{triangle, {}, 0.0};
    const double area = triangle.area();
    const Vec3d& normal = context_.facets[triangle.surface].plane.normal;
    for (const TriangleNode& node : kRule) {
      Vec3d point;
      for (std::size_t i = 0; i < 3; ++i) {
        point = point + node.share.at(i) * triangle.corners.at(i);
      }
      const ScatteringPatch patch{triangle.surface, point, node.weight * area};
      add_side(patch, normal, made);
      add_side(patch, -normal, made);
    }
    return made;
  }

  void add_side(const ScatteringPatch& patch, const Vec3d& side, Cell& made) {
    const bool straight = tracer_.options_.reflections == 0;
    const auto is_before = [&](const LinkEnd<double>& end) {
      return dot(end.position - patch.position, side) > 0.0;
    };
    if (straight && !(is_before(transmitter_) && is_before(receiver_))) {
      return;
    }
    ++points_;
    const auto& froms = from_.find(patch.position, side);
    if (froms.empty()) {
      return;
    }
    const auto known_from = known(froms, transmitter_, patch);
    const auto known_to = known(to_.find(patch.position, side), receiver_, patch);
    for (const KnownLeg& in : known_from) {
      for (const KnownLeg& out : known_to) {
        add_path(patch, in, out, made);
      }
    }
  }

  std::vector<KnownLeg> known(const std::vector<FoundLeg>& found,
                              const LinkEnd<double>& end,
                              const ScatteringPatch& patch) const {
    std::vector<KnownLeg> legs;
    legs.reserve(found.size());
    for (const FoundLeg& leg : found) {
      legs.push_back({&leg,
                      leg_to_patch<double>(
                          end,
                          leg.interactions,
                          [&](std::uint32_t surface) { return context_.facets[surface]; },
                          patch.position,
                          context_.wavelength)});
    }
    return legs;
  }

  void add_path(const ScatteringPatch& patch, const KnownLeg& in, const KnownLeg& out, Cell& made) {
    const std::size_t met = in.found->interactions.size() + out.found->interactions.size() + 1;
    if (in.found->mirrors + out.found->mirrors > tracer_.options_.reflections ||
        met > static_cast<std::size_t>(context_.options.max_depth)) {
      return;
    }
    const RoughMaterial<double>& rough = *tracer_.materials_.of_surface(patch.surface);
    const ScatteredPath<double> path = scattered_path<double>(
        rough, context_.facets[patch.surface], in.leg, out.leg, context_.wavelength);
    made.echoes.push_back({path.power(rough) * patch.area,
                           path.length / kSpeedOfLight,
                           in.leg.departure,
                           out.leg.departure,
                           patch,
                           in.found->interactions,
                           out.found->interactions});
    made.power += made.echoes.back().power;
  }

  const DiffuseTracer& tracer_;
  const TraceContext& context_;
  LinkEnd<double> transmitter_;
  LinkEnd<double> receiver_;
  LegFinder from_;
  LegFinder to_;
  std::vector<Pair> pairs_;  // a heap: the largest difference first
  double power_ = 0.0;
  double error_ = 0.0;
  std::size_t points_ = 0;
};

DiffuseTracer::DiffuseTracer(std::shared_ptr<const Scene> scene,
                             const TraceOptions& trace,
                             const DiffuseOptions& options)
    : context_(std::make_shared<const TraceContext>(std::move(scene), diffuse_options(trace))),
      options_(options),
      materials_(*context_) {
  constexpr int kMaxReflections = 2;  // a count, chosen
  RAYLOC_CHECK(options.reflections >= 0 && options.reflections <= kMaxReflections);
  RAYLOC_CHECK(options.tolerance > 0.0);
}

DiffuseDensity DiffuseTracer::density(const Transmitter& transmitter,
                                      const Receiver& receiver) const {
  return Integration(*this, transmitter, receiver).run();
}

DiffuseDensity DiffuseTracer::again(const DiffuseDensity& density,
                                    const Transmitter& transmitter,
                                    const Receiver& receiver) const {
  const LinkEnd<double> from = link_end(transmitter);
  const LinkEnd<double> to = link_end(receiver);
  const auto facet_of = [&](std::uint32_t surface) { return context_->facets[surface]; };
  std::vector<DiffuseEcho> echoes = density.echoes();
  for (DiffuseEcho& echo : echoes) {
    const ScatteringPatch& patch = echo.patch;
    const RoughMaterial<double>* rough = materials_.of_surface(patch.surface);
    RAYLOC_CHECK(rough != nullptr);
    const auto in =
        leg_to_patch<double>(from, echo.before, facet_of, patch.position, context_->wavelength);
    const auto out =
        leg_to_patch<double>(to, echo.after, facet_of, patch.position, context_->wavelength);
    const ScatteredPath<double> path =
        scattered_path<double>(*rough, facet_of(patch.surface), in, out, context_->wavelength);
    echo.power = path.power(*rough) * patch.area;
    echo.tau = path.length / kSpeedOfLight;
    echo.departure = in.departure;
    echo.arrival = out.departure;
  }
  return {std::move(echoes), density.error()};
}

Expected<DiffuseDerivatives> DiffuseTracer::differentiate(
    const DiffuseDensity& density,
    const Transmitter& transmitter,
    const Receiver& receiver,
    std::span<const Parameter> parameters) const {
  for (const Parameter& parameter : parameters) {
    RAYLOC_TRY(check_parameter(*context_, parameter));
    if (moves_faces(parameter)) {
      return bad_input(
          "no derivative of scattered power by where a face is: its points would move; trace anew");
    }
  }
  return parameters.size() <= 2 ? run<2>(density, transmitter, receiver, parameters)
                                : run<4>(density, transmitter, receiver, parameters);
}

template <int N>
DiffuseDerivatives DiffuseTracer::run(const DiffuseDensity& density,
                                      const Transmitter& transmitter,
                                      const Receiver& receiver,
                                      std::span<const Parameter> parameters) const {
  const auto& echoes = density.echoes();
  DiffuseDerivatives result(echoes.size(), parameters.size());
  const Dual<N> wavelength(context_->wavelength);
  for (std::size_t first = 0; first < parameters.size(); first += N) {
    ParameterBlock<N> block;
    for (std::size_t i = first; i < parameters.size() && i < first + N; ++i) {
      block.parameters[static_cast<std::size_t>(block.size++)] = &parameters[i];
    }
    const LinkEnd<Dual<N>> from = dual_end<N>(transmitter, kTransmitterKinds, block);
    const LinkEnd<Dual<N>> to = dual_end<N>(receiver, kReceiverKinds, block);
    const RoughMaterials::Duals<N> materials(materials_, *context_, block);
    const auto facet_of = [&](std::uint32_t surface) {
      return dual_facet<N>(*context_, surface, block);
    };
    for (std::size_t i = 0; i < echoes.size(); ++i) {
      const ScatteringPatch& patch = echoes[i].patch;
      const auto& rough = materials.of_surface(patch.surface);
      const ScatteredPath<Dual<N>> path = scattered_path<Dual<N>>(
          rough,
          facet_of(patch.surface),
          leg_to_patch<Dual<N>>(from, echoes[i].before, facet_of, patch.position, wavelength),
          leg_to_patch<Dual<N>>(to, echoes[i].after, facet_of, patch.position, wavelength),
          wavelength);
      const Dual<N> power = path.power(rough);
      for (int lane = 0; lane < block.size; ++lane) {
        const std::size_t parameter = first + static_cast<std::size_t>(lane);
        const Kind kind = parameters[parameter].kind;
        const bool is_gain = kind == Kind::kTransmitterGain || kind == Kind::kReceiverGain;
        result.at(i, parameter) = {is_gain ? 2.0 * echoes[i].power : patch.area * power.v[lane],
                                   path.length.v[lane] / kSpeedOfLight};
      }
    }
  }
  return result;
}

}  // namespace rayloc
