#include "engine/calibrate/check/place_mistakes.h"

#include <cmath>
#include <utility>

namespace rayloc {
namespace {

bool is_inside(const RoomModel& room, const Vec3d& p) {
  return p.x >= room.bounds_min.x && p.x <= room.bounds_max.x && p.y >= room.bounds_min.y &&
         p.y <= room.bounds_max.y && p.z >= room.bounds_min.z && p.z <= room.bounds_max.z;
}

// Places from `point` applied to the stated position of each point.
PlaceMistake moved_places(std::string meaning,
                          std::span<const CalibrationPoint> points,
                          const std::function<Vec3d(const Vec3d&)>& point) {
  return {std::move(meaning), [=](std::size_t i) { return point(points[i].position); }};
}

// Places from `row`: the survey row that contains the place of each point.
PlaceMistake reordered_places(std::string meaning,
                              std::span<const CalibrationPoint> points,
                              const std::function<std::size_t(std::size_t)>& row) {
  return {std::move(meaning),
          [=](std::size_t i) { return points[row(i) % points.size()].position; }};
}

// Measured from the other end of the room. With the origin in the middle, this is the opposite
// sign.
void add_other_ends(const RoomModel& room,
                    std::span<const CalibrationPoint> points,
                    std::vector<PlaceMistake>& mistakes) {
  constexpr double kSame = 0.01;  // [m]
  const double x = room.bounds_min.x + room.bounds_max.x;
  const double y = room.bounds_min.y + room.bounds_max.y;
  const bool off_x = std::abs(x) > kSame;
  const bool off_y = std::abs(y) > kSame;
  if (off_x) {
    mistakes.push_back(
        moved_places("with x measured from the other end of the room", points, [=](const Vec3d& p) {
          return Vec3d{x - p.x, p.y, p.z};
        }));
  }
  if (off_y) {
    mistakes.push_back(
        moved_places("with y measured from the other end of the room", points, [=](const Vec3d& p) {
          return Vec3d{p.x, y - p.y, p.z};
        }));
  }
  if (off_x || off_y) {
    mistakes.push_back(moved_places(
        "with x and y measured from the other corner of the room", points, [=](const Vec3d& p) {
          return Vec3d{x - p.x, y - p.y, p.z};
        }));
  }
}

}  // namespace

std::vector<PlaceMistake> mistakes_of_places(const RoomModel& room,
                                             std::span<const CalibrationPoint> points) {
  const std::size_t count = points.size();
  std::vector<PlaceMistake> mistakes = {
      moved_places("with x and y exchanged",
                   points,
                   [](const Vec3d& p) {
                     return Vec3d{p.y, p.x, p.z};
                   }),
      moved_places("with y and z exchanged",
                   points,
                   [](const Vec3d& p) {
                     return Vec3d{p.x, p.z, p.y};
                   }),
      moved_places("with x and z exchanged",
                   points,
                   [](const Vec3d& p) {
                     return Vec3d{p.z, p.y, p.x};
                   }),
      moved_places("with the sign of x changed",
                   points,
                   [](const Vec3d& p) {
                     return Vec3d{-p.x, p.y, p.z};
                   }),
      moved_places("with the sign of y changed",
                   points,
                   [](const Vec3d& p) {
                     return Vec3d{p.x, -p.y, p.z};
                   }),
      moved_places("with the signs of x and y changed",
                   points,
                   [](const Vec3d& p) {
                     return Vec3d{-p.x, -p.y, p.z};
                   }),
      reordered_places(
          "with every place moved one row up", points, [](std::size_t i) { return i + 1; }),
      reordered_places("with every place moved one row down",
                       points,
                       [=](std::size_t i) { return i + count - 1; }),
      reordered_places(
          "with the rows in reverse order", points, [=](std::size_t i) { return count - 1 - i; }),
  };
  add_other_ends(room, points, mistakes);
  std::erase_if(mistakes, [&](const PlaceMistake& mistake) {
    for (std::size_t i = 0; i < count; ++i) {
      if (!is_inside(room, mistake.place(i))) {
        return true;
      }
    }
    return false;
  });
  return mistakes;
}

}  // namespace rayloc
