// MovableThings: the chairs and boxes of a scene, and where else they could stand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/room/room_model.h"
#include "engine/scene/bounds.h"

namespace rayloc {

class MovableThings {
 public:
  explicit MovableThings(const RoomModel& room);

  std::size_t size() const { return things_.size(); }
  // Indices of the scene's objects that touch each other and move as one: a seat and its back.
  const std::vector<std::uint32_t>& objects(std::size_t thing) const { return things_[thing]; }

  // Whether it would stand in the room and meet neither another object, where those are now, nor
  // an access point.
  bool fits(std::size_t thing, const Vec3d& by) const;
  void move(std::size_t thing, const Vec3d& by);

 private:
  Vec3d lower_;  // [m], of the room
  Vec3d upper_;
  std::vector<Vec3d> access_points_;  // [m]
  std::vector<Bounds> objects_;       // of each object of the scene
  std::vector<std::vector<std::uint32_t>> things_;
};

}  // namespace rayloc
