#include "daemon/live/live_map/wall_openings.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "engine/scene/bounds.h"

namespace rayloc {
namespace {

using Points = std::vector<Vec3d>;

constexpr std::array<std::string_view, 4> kDoors = {"door", "tuer", "tür", "porte"};
constexpr std::array<std::string_view, 4> kWindows = {"window", "fenster", "fenetre", "fenêtre"};
constexpr double kNarrowest = 0.3;   // [m]
constexpr double kThickest = 0.4;    // [m]
constexpr double kSill = 0.3;        // [m], above it a pane of glass is no wall
constexpr double kBeside = 0.06;     // [m] between an opening and its wall
constexpr double kShallowest = 0.1;  // [m], drawn depth of a pane without a wall

// True if a word of the name begins with it. Letters beyond ASCII are part of a word.
template <std::size_t N>
bool is_called(const std::string& name, const std::array<std::string_view, N>& words) {
  std::string lower;
  lower.reserve(name.size());
  for (const char c : name) {
    lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  const auto begins_word = [&](std::size_t at) {
    return at == 0 || (std::isalpha(static_cast<unsigned char>(lower[at - 1])) == 0 &&
                       static_cast<unsigned char>(lower[at - 1]) < 0x80U);
  };
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) {
    std::size_t at = lower.find(word);
    while (at != std::string::npos && !begins_word(at)) {
      at = lower.find(word, at + 1);
    }
    return at != std::string::npos;
  });
}

// The axes along an opening and across it.
struct Axes {
  Vec3d along;
  Vec3d across;
};

struct Extent {
  double low = 0.0;
  double high = 0.0;
  double size() const { return high - low; }
};

Extent extent(const Points& points, const Vec3d& axis) {
  Extent found{dot(points.front(), axis), dot(points.front(), axis)};
  for (const Vec3d& point : points) {
    found.low = std::min(found.low, dot(point, axis));
    found.high = std::max(found.high, dot(point, axis));
  }
  return found;
}

bool meet(const Extent& a, const Extent& b) {
  return a.low <= b.high + kBeside && b.low <= a.high + kBeside;
}

std::vector<Points> pieces(const draw::MeshSection& section) {
  std::vector<Points> all = section.loops;
  all.insert(all.end(), section.lines.begin(), section.lines.end());
  return all;
}

// Determined by the longest edge; empty if all points coincide.
std::optional<Axes> axes_of(const std::vector<Points>& all) {
  Vec3d longest{};
  for (const Points& points : all) {
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const Vec3d edge = points[i + 1] - points[i];
      longest = dot(edge, edge) > dot(longest, longest) ? edge : longest;
    }
  }
  if (dot(longest, longest) < kNarrowest * kNarrowest) {
    return std::nullopt;
  }
  const Vec3d along = normalized(longest);
  return Axes{along, {-along.y, along.x, 0.0}};
}

// Walls that are parallel to the gap and meet it extend its depth to their own.
void widen(Extent& across, const Extent& along, const Axes& axes, const Points& wall) {
  const Extent wall_across = extent(wall, axes.across);
  if (wall_across.size() <= kThickest && meet(extent(wall, axes.along), along) &&
      meet(wall_across, across)) {
    const Extent both{std::min(across.low, wall_across.low),
                      std::max(across.high, wall_across.high)};
    across = both.size() <= 2.0 * kThickest ? both : across;
  }
}

class Finder {
 public:
  Finder(const std::vector<draw::ScenePart>& parts, const draw::FloorPlan& plan)
      : parts_(parts), plan_(plan) {
    for (const draw::ScenePart& part : parts) {
      all_.include(part.bounds.lower);
      all_.include(part.bounds.upper);
    }
  }

  std::optional<WallOpening> opening(const draw::FloorPlan::Cut& cut) const {
    const draw::ScenePart& part = parts_[cut.object];
    const bool is_door = is_called(part.name, kDoors);
    const bool is_pane = part.material == "glass" && part.bounds.lower.z > all_.lower.z + kSill;
    if (!is_door && !is_called(part.name, kWindows) && !is_pane) {
      return std::nullopt;
    }
    const std::vector<Points> own = pieces(cut.section);
    const std::optional<Axes> axes = axes_of(own);
    if (!axes) {
      return std::nullopt;
    }
    Points points;
    for (const Points& piece : own) {
      points.insert(points.end(), piece.begin(), piece.end());
    }
    const Extent along = extent(points, axes->along);
    Extent across = extent(points, axes->across);
    if (across.size() > kThickest) {
      return std::nullopt;
    }
    for (const draw::FloorPlan::Cut& other : plan_.cuts) {
      if (parts_[other.object].kind == draw::PartKind::kWall && other.object != cut.object) {
        for (const Points& wall : pieces(other.section)) {
          widen(across, along, *axes, wall);
        }
      }
    }
    const double missing = std::max(0.0, 0.5 * (kShallowest - across.size()));
    return placed(
        {is_door, cut.object, {}}, *axes, along, {across.low - missing, across.high + missing});
  }

 private:
  // The hinge is on the side of the nearer corner, so that the door opens against the wall there.
  WallOpening placed(WallOpening found, const Axes& axes, Extent along, Extent across) const {
    const Vec3d middle = 0.5 * (all_.lower + all_.upper);
    if (std::abs(dot(middle, axes.across) - across.low) >
        std::abs(dot(middle, axes.across) - across.high)) {
      std::swap(across.low, across.high);
    }
    if (std::abs(dot(middle, axes.along) - along.low) <
        std::abs(dot(middle, axes.along) - along.high)) {
      std::swap(along.low, along.high);
    }
    const auto at = [&](double u, double v) { return u * axes.along + v * axes.across; };
    found.corners = {at(along.low, across.low),
                     at(along.high, across.low),
                     at(along.high, across.high),
                     at(along.low, across.high)};
    return found;
  }

  const std::vector<draw::ScenePart>& parts_;
  const draw::FloorPlan& plan_;
  Bounds all_;
};

}  // namespace

std::vector<WallOpening> wall_openings(const std::vector<draw::ScenePart>& parts,
                                       const draw::FloorPlan& plan) {
  const Finder finder(parts, plan);
  std::vector<WallOpening> found;
  for (const draw::FloorPlan::Cut& cut : plan.cuts) {
    if (const std::optional<WallOpening> one = finder.opening(cut)) {
      found.push_back(*one);
    }
  }
  return found;
}

}  // namespace rayloc
