#include "daemon/lab/simulate/second_day.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>

#include "daemon/lab/simulate/movable_things.h"
#include "daemon/lab/simulate/random_stream.h"
#include "daemon/lab/simulate/rotations.h"
#include "engine/base/constants.h"
#include "engine/scene/scene.h"

namespace rayloc {
namespace {

constexpr int kMaxPlaces = 200;                  // attempts per thing
constexpr std::uint64_t kMaxAccessPoints = 256;  // streams per day

// The stream of one access point (or of the room, the 0th) on one day.
RandomStream stream_of(std::uint64_t seed,
                       const SecondDay& day,
                       std::string_view purpose,
                       std::size_t access_point = 0) {
  return random_stream(
      seed, purpose, static_cast<std::uint64_t>(day.day) * kMaxAccessPoints + access_point);
}

Vec3d draw_direction(RandomStream& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random);
  const double y = normal(random);
  return normalized(Vec3d{x, y, normal(random)});
}

std::vector<std::complex<double>> draw_chains(std::size_t chains,
                                              const SecondDay& day,
                                              RandomStream random) {
  std::vector<std::complex<double>> factors;
  if (day.chain_phase_deg == 0.0 && day.chain_gain_db == 0.0) {
    return factors;
  }
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> turn(-1.0, 1.0);
  for (std::size_t i = 0; i < chains; ++i) {
    const double gain_db = day.chain_gain_db * normal(random);
    factors.push_back(
        std::polar(std::pow(10.0, gain_db / 20.0), kDegree * day.chain_phase_deg * turn(random)));
  }
  return factors;
}

// Moves the pose and returns the change.
BumpedAccessPoint bump(Pose& pose, const SecondDay& day, RandomStream random) {
  BumpedAccessPoint bumped;
  const Vec3d direction = draw_direction(random);
  const Vec3d axis = draw_direction(random);
  if (day.access_point_moved_m > 0.0) {
    bumped.moved = day.access_point_moved_m * direction;
    pose.position = pose.position + bumped.moved;
  }
  if (day.access_point_turned_deg > 0.0) {
    const Orientation before = pose.orientation;
    const Mat3d turn = rotation_about(axis, kDegree * day.access_point_turned_deg);
    pose.orientation = orientation_of(turn * rotation(before));
    const auto less = [](double after, double earlier) {
      return std::remainder(after - earlier, 2.0 * std::numbers::pi);
    };
    bumped.rotated = {less(pose.orientation.yaw, before.yaw),
                      less(pose.orientation.pitch, before.pitch),
                      less(pose.orientation.roll, before.roll)};
  }
  return bumped;
}

// A free displacement of a thing; zero if there is none.
Vec3d draw_move(const MovableThings& things,
                std::size_t thing,
                const SecondDay& day,
                RandomStream& random) {
  std::uniform_real_distribution<double> distance(day.moved_least_m, day.moved_most_m);
  std::uniform_real_distribution<double> angle(0.0, 2.0 * std::numbers::pi);
  for (int n = 0; n < kMaxPlaces; ++n) {
    const double by = distance(random);
    const double towards = angle(random);
    const Vec3d move{by * std::cos(towards), by * std::sin(towards), 0.0};
    if (things.fits(thing, move)) {
      return move;
    }
  }
  return {};
}

std::vector<std::size_t> shuffled(std::size_t count, RandomStream& random) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t left = count; left > 1; --left) {
    std::swap(order[left - 1], order[random() % left]);
  }
  return order;
}

Expected<void> move_things(LivedInRoom& lived, const SecondDay& day, RandomStream random) {
  const Scene& before = *lived.room.scene;
  Scene::Input input{before.objects(), before.materials(), before.carrier_hz(), before.notes()};
  MovableThings things(lived.room);
  for (const std::size_t thing : shuffled(things.size(), random)) {
    if (static_cast<double>(lived.moved.size()) >= day.moved_things) {
      break;
    }
    const Vec3d by = draw_move(things, thing, day, random);
    if (by == Vec3d{}) {
      continue;
    }
    things.move(thing, by);
    MovedThing moved{{}, by};
    for (const std::uint32_t object : things.objects(thing)) {
      moved.objects.push_back(input.objects[object].name);
      for (Vec3d& vertex : input.objects[object].mesh.vertices) {
        vertex = vertex + by;
      }
    }
    lived.moved.push_back(std::move(moved));
  }
  if (lived.moved.empty()) {
    return {};
  }
  const std::size_t surfaces = before.surfaces().size();
  auto after = Scene::create(std::move(input));
  RAYLOC_TRY(after);
  // Corrections of a calibration are indexed by surface.
  if (after->surfaces().size() != surfaces) {
    return bad_input("the scene has other surfaces once its furniture is moved");
  }
  lived.room.scene = std::make_shared<const Scene>(*std::move(after));
  return {};
}

}  // namespace

Expected<LivedInRoom> live_in(const RoomModel& room, const SecondDay& day, std::uint64_t seed) {
  LivedInRoom lived{room, {}, {}};
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    Pose& pose = lived.room.access_points[i].array.pose;
    lived.access_points.push_back(bump(pose, day, stream_of(seed, day, "bump", i)));
    lived.access_points.back().chain_changes = draw_chains(
        room.access_points[i].rx_chains.size(), day, stream_of(seed, day, "power cycle", i));
  }
  if (day.moved_things > 0.0) {
    RAYLOC_TRY(move_things(lived, day, stream_of(seed, day, "furniture")));
  }
  return lived;
}

}  // namespace rayloc
