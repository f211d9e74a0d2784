#include "daemon/site/model/scene_frame.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "daemon/site/model/length_unit.h"

namespace rayloc {
namespace {

constexpr double kReach = 0.5;         // [m], of a side of the box to a face: a wall, a panel
constexpr double kReachShare = 0.125;  // maximum share of the room's size
constexpr double kSizeSlack = 0.6;     // [m], excess of a scene over its room: two walls
constexpr double kSizeShare = 0.1;     // plus this share of it
constexpr double kMaxShare = 0.3;      // maximum share
constexpr double kSmallestRoom = 1.2;  // [m]; smaller ones match too many other objects
constexpr double kSameOrigin = 0.1;    // [m]
constexpr int kAllSides = 6;
constexpr int kMinFrameSides = 5;  // the sixth side may be open
constexpr int kClearlyMore = 2;    // sides than with the scene's own frame

std::array<double, 3> coordinates(const Vec3d& v) { return {v.x, v.y, v.z}; }
Vec3d as_vector(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }

Bounds to_room(const SceneFrame& frame, const Bounds& scene) {
  const Vec3d a = frame.to_room(scene.lower);
  const Vec3d b = frame.to_room(scene.upper);
  return {{std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)},
          {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}};
}

bool contains(const Bounds& outer, const Bounds& inner, double slack) {
  const Vec3d margin{slack, slack, slack};
  const Bounds widened{outer.lower - margin, outer.upper + margin};
  return widened.contains(inner.lower) && widened.contains(inner.upper);
}

bool is_as_large(const Vec3d& scene, const Vec3d& room) {
  const auto s = coordinates(scene);
  const auto r = coordinates(room);
  for (std::size_t i = 0; i < 3; ++i) {
    const double slack = std::min(kSizeSlack + kSizeShare * r.at(i), kMaxShare * r.at(i));
    if (std::abs(s.at(i) - r.at(i)) > slack) {
      return false;
    }
  }
  return true;
}

// All assignments and directions of three axes; first the usual one, then those with y up.
std::vector<std::array<SceneFrame::Axis, 3>> all_axes() {
  std::vector<std::array<SceneFrame::Axis, 3>> all = {{{{0, 1.0}, {1, 1.0}, {2, 1.0}}},
                                                      {{{0, 1.0}, {2, -1.0}, {1, 1.0}}},
                                                      {{{0, 1.0}, {2, 1.0}, {1, 1.0}}}};
  std::array<std::size_t, 3> order = {0, 1, 2};
  do {
    for (unsigned signs = 0; signs < 8; ++signs) {
      std::array<SceneFrame::Axis, 3> axes;
      for (std::size_t i = 0; i < 3; ++i) {
        axes.at(i) = {order.at(i), ((signs >> i) & 1U) == 0 ? 1.0 : -1.0};
      }
      all.push_back(axes);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return all;
}
constexpr std::size_t kUsualAxes = 3;  // at the beginning of all_axes()

struct Candidate {
  SceneFrame frame;
  double penalty = 0.0;  // smaller means simpler and better
};

// Distance between the corners of two boxes [m].
double misfit(const Bounds& a, const Bounds& b) {
  return norm(a.lower - b.lower) + norm(a.upper - b.upper);
}

// Frames in which the scene's box fits that of the room.
std::vector<Candidate> candidates(const Bounds& scene, const Bounds& room) {
  // Every change of unit, axes or origin must reduce the distance of the boxes by this [m].
  constexpr double kPerChange = 0.2;
  constexpr double kOfALargerScene = 0.5;  // its box is not informative [m]
  std::vector<double> scales = {1.0};
  for (const LengthUnit& unit : kMistakenUnits) {
    scales.push_back(unit.metres);
    scales.push_back(1.0 / unit.metres);
  }
  std::vector<Candidate> found;
  const auto all = all_axes();
  for (const double scale : scales) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      SceneFrame frame;
      frame.scale = scale;
      frame.axes = all[i];
      const Bounds box = to_room(frame, scene);
      const bool as_large = is_as_large(box.size(), room.size());
      const double changes =
          kPerChange * ((frame.is_scaled() ? 1.0 : 0.0) + (frame.is_rotated() ? 1.0 : 0.0));
      if (contains(box, room, kReach) && (as_large || i < kUsualAxes)) {
        found.push_back({frame, changes + (as_large ? misfit(box, room) : kOfALargerScene)});
      }
      const bool is_there = contains(frame.is_scaled() ? box : scene, room, kSameOrigin);
      if (as_large && !is_there) {
        frame.shift = 0.5 * ((room.lower + room.upper) - (box.lower + box.upper));
        found.push_back({frame, changes + kPerChange + misfit(to_room(frame, scene), room)});
      }
    }
  }
  std::stable_sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
    return a.penalty < b.penalty;
  });
  return found;
}

// Returns true if more than half of the side `axis` of the room, at the lower or the upper end, is
// on a face.
bool has_face(
    const Scene& scene, const SceneFrame& frame, const Bounds& room, std::size_t axis, bool upper) {
  constexpr int kSamples = 9;  // per axis: odd, so that a seam in the middle does not hide all
  const auto low = coordinates(room.lower);
  const auto size = coordinates(room.size());
  const double reach = std::min(kReach, kReachShare * size.at(axis));
  const std::size_t u = (axis + 1) % 3;
  const std::size_t v = (axis + 2) % 3;
  int hits = 0;
  for (int i = 0; i < kSamples; ++i) {
    for (int k = 0; k < kSamples; ++k) {
      std::array<double, 3> p{};
      p.at(u) = low.at(u) + size.at(u) * (i + 0.5) / kSamples;
      p.at(v) = low.at(v) + size.at(v) * (k + 0.5) / kSamples;
      p.at(axis) = low.at(axis) + (upper ? size.at(axis) : 0.0) - reach;
      const Vec3d from = frame.to_scene(as_vector(p));
      p.at(axis) += 2.0 * reach;
      hits += scene.is_blocked({from, frame.to_scene(as_vector(p))}) ? 1 : 0;
    }
  }
  return 2 * hits > kSamples * kSamples;
}

}  // namespace

std::string size_text(const Vec3d& size) {
  return fmt::format("{:.4g} x {:.4g} x {:.4g} m", size.x, size.y, size.z);
}

bool SceneFrame::is_rotated() const {
  for (std::size_t i = 0; i < 3; ++i) {
    if (axes.at(i).of_scene != i || axes.at(i).sign < 0.0) {
      return true;
    }
  }
  return false;
}

Vec3d SceneFrame::to_room(const Vec3d& p) const {
  const auto from = coordinates(p);
  std::array<double, 3> to{};
  for (std::size_t i = 0; i < 3; ++i) {
    to.at(i) = scale * axes.at(i).sign * from.at(axes.at(i).of_scene);
  }
  return as_vector(to) + shift;
}

Vec3d SceneFrame::to_scene(const Vec3d& p) const {
  const auto from = coordinates(p - shift);
  std::array<double, 3> to{};
  for (std::size_t i = 0; i < 3; ++i) {
    to.at(axes.at(i).of_scene) = axes.at(i).sign * from.at(i) / scale;
  }
  return as_vector(to);
}

int covered_sides(const Scene& scene, const SceneFrame& frame, const Bounds& room) {
  int sides = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const bool upper : {false, true}) {
      sides += has_face(scene, frame, room, axis, upper) ? 1 : 0;
    }
  }
  return sides;
}

std::optional<SceneFrame> find_frame(const Scene& scene, const Bounds& room) {
  const Vec3d size = room.size();
  if (std::min({size.x, size.y, size.z}) < kSmallestRoom) {
    return std::nullopt;
  }
  const int as_it_is = covered_sides(scene, {}, room);
  const int needed = std::max(kMinFrameSides, as_it_is + kClearlyMore);
  std::optional<SceneFrame> best;
  int most = needed - 1;
  for (const Candidate& candidate : candidates({scene.bounds_min(), scene.bounds_max()}, room)) {
    if (const int sides = covered_sides(scene, candidate.frame, room); sides > most) {
      most = sides;
      best = candidate.frame;
    }
    if (most == kAllSides) {
      break;
    }
  }
  return best;
}

}  // namespace rayloc
