// MovableThings: the chairs and boxes of a scene, and their possible other positions.
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
  // Indices of scene objects that touch each other and move as one: a seat and its back.
  const std::vector<std::uint32_t>& objects(std::size_t thing) const { return things_[thing]; }

  // True if it would be inside the room and overlap neither
  // another object at its present position nor an access point.
  bool fits(std::size_t thing, const Vec3d& by) const;
  void move(std::size_t thing, const Vec3d& by);

 private:
  Vec3d lower_;  // [m], lower corner of the room
  Vec3d upper_;
  std::vector<Vec3d> access_points_;  // [m]
  std::vector<Bounds> objects_;       // by object of the scene
  std::vector<std::vector<std::uint32_t>> things_;
};

}  // namespace rayloc
