#include "engine/trace/diffraction/edge_pair.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace rayloc {
namespace {

constexpr double kMinEdgeDistance = 1e-6;  // [m], chosen: closer points have no bend
constexpr double kExact = 1e-12;           // [m], chosen: length of a negligible step
constexpr int kMaxSteps = 60;              // a count, chosen: a few are usual

using Edges = std::pair<EdgeLine<double>, EdgeLine<double>>;

double length_of(const Edges& edges,
                 const Vec3d& source,
                 const Vec3d& observer,
                 const EdgePairBends<double>& bends) {
  const EdgePairRoute<double> route = edge_pair_route(edges, source, observer, bends);
  return route.before + route.between + route.behind;
}

}  // namespace

std::optional<EdgePairBends<double>> shortest_over(const Edges& edges,
                                                   const Vec3d& source,
                                                   const Vec3d& observer) {
  // Starts where each line is nearest to the middle of the ends.
  const Vec3d middle = 0.5 * (source + observer);
  EdgePairBends<double> bends{dot(middle - edges.first.from, edges.first.along),
                              dot(middle - edges.second.from, edges.second.along)};
  double length = length_of(edges, source, observer, bends);
  for (int i = 0; i < kMaxSteps; ++i) {
    const EdgePairRoute<double> route = edge_pair_route(edges, source, observer, bends);
    if (std::min({route.before, route.between, route.behind}) < kMinEdgeDistance) {
      return std::nullopt;
    }
    const EdgePairBends<double> aim = improved(edges, source, observer, bends);
    double by_first = aim.first - bends.first;
    double by_second = aim.second - bends.second;
    if (!(std::isfinite(by_first) && std::isfinite(by_second))) {
      return std::nullopt;
    }
    if (std::max(std::abs(by_first), std::abs(by_second)) < kExact) {
      return aim;
    }
    // The length is convex: half of a step that is too long shortens the path.
    EdgePairBends<double> next = aim;
    double shorter = length_of(edges, source, observer, next);
    for (int halved = 0; shorter > length && halved < kMaxSteps; ++halved) {
      by_first *= 0.5;
      by_second *= 0.5;
      next = {bends.first + by_first, bends.second + by_second};
      shorter = length_of(edges, source, observer, next);
    }
    if (shorter > length) {
      return bends;  // rounding exceeds the remaining improvement
    }
    bends = next;
    length = shorter;
  }
  return bends;
}

std::optional<SharedSide> shared_side(const std::pair<const Wedge&, const Wedge&>& edges,
                                      bool along_face_n) {
  constexpr double kSame = 0.9;  // a cosine, chosen: one side of the face or the other
  const auto& [first, second] = edges;
  const std::uint32_t face = along_face_n ? first.face_n : first.face_0;
  const Vec3d outward = along_face_n ? first.normal_n() : first.normal;
  const double at_first = along_face_n ? first.n * std::numbers::pi : 0.0;
  if (second.face_0 == face && dot(outward, second.normal) > kSame) {
    return SharedSide{at_first, 0.0};
  }
  if (second.face_n == face && dot(outward, second.normal_n()) > kSame) {
    return SharedSide{at_first, second.n * std::numbers::pi};
  }
  return std::nullopt;
}

}  // namespace rayloc
