#include "daemon/lab/experiment/study_walk.h"

#include <cmath>
#include <numbers>
#include <random>
#include <string>

namespace rayloc {
namespace {

constexpr double kArcDuration = 0.25;    // [s]
constexpr double kCheckInterval = 0.04;  // [m], along an arc
constexpr int kPlaceAttempts = 2000;     // for the first place
constexpr int kCurvatureAttempts = 30;   // for an arc, before the turn that is known to be free

struct Heading {
  Vec3d place;
  double angle = 0.0;  // [rad], from the x axis
};

// The heading after `length` [m] along an arc of `curvature` [1/m], positive to the left.
Heading along(const Heading& from, double curvature, double length) {
  const double turn = curvature * length;
  const double half = 0.5 * turn;
  const double chord = length * (std::abs(half) < 1e-9 ? 1.0 : std::sin(half) / half);
  return {{from.place.x + chord * std::cos(from.angle + half),
           from.place.y + chord * std::sin(from.angle + half),
           from.place.z},
          from.angle + turn};
}

class Walker {
 public:
  Walker(const WalkShape& shape, const std::function<bool(const Vec3d&)>& is_free)
      : shape_(shape), is_free_(is_free) {}

  bool is_arc_free(const Heading& from, double curvature, double length) const {
    const int steps = static_cast<int>(std::ceil(length / kCheckInterval));
    for (int i = 0; i <= steps; ++i) {
      if (!is_free_(along(from, curvature, length * i / steps).place)) {
        return false;
      }
    }
    return true;
  }

  // The curvature of a full turn that is free; 0: none.
  double free_turn(const Heading& from) const {
    const double narrowest = 1.0 / shape_.turn_radius;
    for (const double curvature : {narrowest, -narrowest}) {
      if (is_arc_free(from, curvature, 2.0 * std::numbers::pi * shape_.turn_radius)) {
        return curvature;
      }
    }
    return 0.0;
  }

  // The next arc: free, with a free turn at its end. `turn`: the free turn at `from`, used as the
  // arc if no drawn arc is suitable; updated to the free turn at the end of the arc.
  double next_curvature(const Heading& from, double& turn, RandomStream& random) const {
    const double length = shape_.speed * kArcDuration;
    std::normal_distribution<double> draw(0.0, 0.5 / shape_.turn_radius);
    for (int attempt = 0; attempt < kCurvatureAttempts; ++attempt) {
      const double curvature = draw(random);
      if (std::abs(curvature) * shape_.turn_radius > 1.0 || !is_arc_free(from, curvature, length)) {
        continue;
      }
      if (const double next = free_turn(along(from, curvature, length)); next != 0.0) {
        turn = next;
        return curvature;
      }
    }
    return turn;
  }

 private:
  const WalkShape& shape_;
  const std::function<bool(const Vec3d&)>& is_free_;
};

}  // namespace

std::vector<Vec3d> draw_walk(const WalkShape& shape,
                             const std::function<Vec3d(RandomStream&)>& any_place,
                             const std::function<bool(const Vec3d&)>& is_free,
                             RandomStream& random) {
  const Walker walker(shape, is_free);
  std::uniform_real_distribution<double> any_angle(-std::numbers::pi, std::numbers::pi);
  Heading at;
  double turn = 0.0;
  for (int attempt = 0; attempt < kPlaceAttempts && turn == 0.0; ++attempt) {
    at = {any_place(random), any_angle(random)};
    turn = walker.free_turn(at);
  }
  std::vector<Vec3d> places;
  if (turn == 0.0) {
    return places;
  }
  const auto count = static_cast<std::size_t>(std::lround(shape.duration * shape.rate));
  double curvature = walker.next_curvature(at, turn, random);
  std::size_t arc = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double time = static_cast<double>(i) / shape.rate;
    while (time >= static_cast<double>(arc + 1) * kArcDuration) {
      at = along(at, curvature, shape.speed * kArcDuration);
      curvature = walker.next_curvature(at, turn, random);
      ++arc;
    }
    const double since = time - static_cast<double>(arc) * kArcDuration;
    places.push_back(along(at, curvature, shape.speed * since).place);
  }
  return places;
}

Expected<std::vector<std::vector<Vec3d>>> draw_walks(const StudyPlaces& places,
                                                     std::uint64_t seed,
                                                     std::size_t layout) {
  const Condition& condition = places.condition;
  WalkShape shape;
  shape.speed = condition.walk_speed_m_s;
  shape.duration = condition.walk_s;
  shape.rate = condition.rate_hz;
  AnyPlace any(places);
  const auto any_place = [&](RandomStream& random) { return any.draw(random); };
  const auto is_free = [&](const Vec3d& place) {
    return places.is_between_walls(place) && places.is_clear(place);
  };
  std::vector<std::vector<Vec3d>> walks;
  for (std::size_t i = 0; i < static_cast<std::size_t>(condition.test_points); ++i) {
    // One random stream per walk: another rate or duration does not change the paths.
    constexpr std::size_t kMaxWalks = 10'000;  // per layout: the limit of Condition::test_points
    RandomStream random = random_stream(seed, "walk", layout * kMaxWalks + i);
    walks.push_back(draw_walk(shape, any_place, is_free, random));
    if (walks.back().empty()) {
      return make_error(ErrorKind::kConfiguration,
                        condition.room.string() +
                            ": a person has no room to turn around anywhere; use fewer boxes or "
                            "another plan");
    }
  }
  return walks;
}

}  // namespace rayloc
