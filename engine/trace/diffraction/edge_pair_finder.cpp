#include "engine/trace/diffraction/edge_pair_finder.h"

#include <cstddef>
#include <optional>

namespace rayloc {
namespace {

// Edges nearer to one line are on it [m], chosen: no path bends from one to the other.
constexpr double kOnLine = 1e-6;

double distance_from_line(const Wedge& wedge, const Vec3d& point) {
  return norm(cross(point - wedge.from, wedge.along));
}

// Inside the wedge, not on its faces.
bool is_within_wedge(const Wedge& wedge, const Vec3d& point) {
  const Vec3d off = point - wedge.from;
  const double above_0 = dot(off, wedge.normal);
  const double above_n = dot(off, wedge.normal_n());
  return !wedge.is_free() && above_0 < -kOffEdge && above_n < -kOffEdge;
}

LinkEnd<double> end_at(const Vec3d& point) {
  LinkEnd<double> end;
  end.position = point;
  return end;
}

}  // namespace

bool EdgePairFinder::may_follow(std::uint32_t first, std::uint32_t second) const {
  const Wedge& one = context_->wedges[first];
  const Wedge& two = context_->wedges[second];
  const auto are_in_line = [](const Wedge& line, const Wedge& other) {
    return distance_from_line(line, other.from) < kOnLine &&
           distance_from_line(line, other.to) < kOnLine;
  };
  // A wedge is convex: an edge with both ends in it has no part outside.
  const auto hides = [](const Wedge& wedge, const Wedge& other) {
    return is_within_wedge(wedge, other.from) && is_within_wedge(wedge, other.to);
  };
  return first != second && !are_in_line(one, two) && !hides(one, two) && !hides(two, one);
}

std::vector<EdgePairFinder::Between> EdgePairFinder::routes_between(std::uint32_t first,
                                                                    std::uint32_t second) const {
  std::vector<Between> routes;
  for (const bool along_face_n : {false, true}) {
    if (shared_side({context_->wedges[first], context_->wedges[second]}, along_face_n)) {
      routes.emplace_back(along_face_n);
    }
  }
  if (routes.empty()) {
    routes.emplace_back(std::nullopt);
  }
  return routes;
}

bool EdgePairFinder::find(const Pair& pair,
                          const LitRoute& from,
                          const LitRoute& to,
                          const Between& between) {
  const auto most = static_cast<std::size_t>(context_->options.max_depth);
  if (from.lit.mirrors + to.lit.mirrors + 2 > most) {
    return false;
  }
  const Wedge& first = context_->wedges[pair.first];
  const Wedge& second = context_->wedges[pair.second];
  const auto image = [](const LitRoute& route) {
    return route.lit.node == kRootNode ? route.end.end()
                                       : route.end.tree().image(route.end.root(), route.lit.node);
  };
  const auto bends =
      shortest_over({edge_line<double>(first), edge_line<double>(second)}, image(from), image(to));
  const auto is_on = [](double height, const LitEdge& lit, const Wedge& wedge) {
    return height >= lit.lower && height <= lit.upper && height > 0.0 &&
           height < norm(wedge.to - wedge.from);
  };
  if (!bends || !is_on(bends->first, from.lit, first) || !is_on(bends->second, to.lit, second)) {
    return false;
  }
  const Vec3d bend = first.from + bends->first * first.along;
  const Vec3d other = second.from + bends->second * second.along;
  if (is_within_wedge(first, other) || is_within_wedge(second, bend) ||
      !before_.trace(from, bend) || !after_.trace(to, other)) {
    return false;
  }
  if (!before_.find(from, beside_edge(first, bend)) ||
      !after_.find(to, beside_edge(second, other)) ||
      !(between ? is_joined(first, bend, other, *between)
                : is_open(beside_edge(first, bend), beside_edge(second, other))) ||
      before_.met().size() + between_.size() + after_.met().size() + 2 > most) {
    return false;
  }
  interactions_.assign(before_.met().rbegin(), before_.met().rend());
  for (const auto& [edge, where] : {std::pair(pair.first, bend), std::pair(pair.second, other)}) {
    interactions_.push_back(turn_at(*context_, edge, where));
    interactions_.back().along_face_n = between.value_or(false);
    if (edge == pair.first) {
      interactions_.insert(interactions_.end(), between_.begin(), between_.end());
    }
  }
  interactions_.insert(interactions_.end(), after_.met().begin(), after_.met().end());
  return true;
}

bool EdgePairFinder::is_open(const Vec3d& from, const Vec3d& to) {
  if (!context_->options.transmission && context_->scene->is_blocked({from, to})) {
    return false;
  }
  return finder_.find({}, end_at(from), end_at(to), between_);
}

// True if the face continues below the whole path, and no object is on it.
bool EdgePairFinder::is_joined(const Wedge& first,
                               const Vec3d& bend,
                               const Vec3d& other,
                               bool along_face_n) {
  const std::uint32_t face = along_face_n ? first.face_n : first.face_0;
  const Vec3d outward = along_face_n ? first.normal_n() : first.normal;
  // Positions along the path at which the face is tested, chosen: a face has few corners.
  for (const double share : {0.01, 0.25, 0.5, 0.75, 0.99}) {
    if (!context_->scene->surfaces()[face].contains(bend + share * (other - bend))) {
      return false;
    }
  }
  return is_open(bend + kOffEdge * outward, other + kOffEdge * outward) && between_.empty();
}

}  // namespace rayloc
