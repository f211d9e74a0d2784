#include "tests/support/office_floor.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/support/box_scene.h"

namespace rayloc::test {
namespace {

constexpr double kRoomX = 4.0;  // [m], with one partition in each direction
constexpr double kRoomY = 5.0;
constexpr double kCorridor = 2.0;  // in front of each row of rooms
constexpr double kFloorHeight = 2.8;
constexpr double kPartition = 0.1;
constexpr double kSlab = 0.3;
constexpr std::size_t kTrianglesPerBox = 12;
constexpr std::size_t kMinBoxes = 8;
constexpr std::size_t kShellBoxes = 5;

// Relative to the corner of the room where the corridor begins; the door is a gap in the south.
const std::vector<SceneBox>& room_boxes() {
  static const std::vector<SceneBox> kBoxes = {
      {"north", "plasterboard", {0, kRoomY - kPartition, 0}, {kRoomX, kRoomY, kFloorHeight}},
      {"west", "plasterboard", {0, 0, 0}, {kPartition, kRoomY - kPartition, kFloorHeight}},
      {"south left", "plasterboard", {kPartition, 0, 0}, {2.6, kPartition, kFloorHeight}},
      {"south right", "plasterboard", {3.5, 0, 0}, {kRoomX, kPartition, kFloorHeight}},
      {"desk top", "chipboard", {0.8, 3.4, 0.72}, {2.4, 4.2, 0.75}},
      {"desk left", "chipboard", {0.8, 3.4, 0}, {0.83, 4.2, 0.72}},
      {"desk right", "chipboard", {2.37, 3.4, 0}, {2.4, 4.2, 0.72}},
      {"screen", "glass", {1.3, 4.0, 0.8}, {1.9, 4.03, 1.2}},
      {"seat", "wood", {1.4, 2.7, 0.45}, {1.9, 3.2, 0.5}},
      {"back", "wood", {1.4, 2.66, 0.6}, {1.9, 2.7, 1.0}},
      {"leg", "metal", {1.6, 2.9, 0}, {1.7, 3.0, 0.45}},
      {"cupboard", "metal", {3.3, 3.2, 0}, {3.9, 4.6, 1.9}}};
  return kBoxes;
}

SceneBox moved(SceneBox box, const Vec3d& by, std::size_t room) {
  box.name += " of room " + std::to_string(room);
  box.lower = box.lower + by;
  box.upper = box.upper + by;
  return box;
}

}  // namespace

std::shared_ptr<const Scene> office_floor(std::size_t triangles) {
  const std::size_t count = std::max(triangles / kTrianglesPerBox, kMinBoxes);
  const std::size_t in_room = room_boxes().size();
  const std::size_t rooms = (count - kShellBoxes + in_room - 1) / in_room;
  const auto columns = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(rooms))));
  const std::size_t rows = (rooms + columns - 1) / columns;
  const double x = static_cast<double>(columns) * kRoomX;
  const double y = static_cast<double>(rows) * (kRoomY + kCorridor) - kCorridor;

  std::vector<SceneBox> boxes = {
      {"floor", "concrete", {0, -kCorridor, -kSlab}, {x, y, 0}},
      {"ceiling", "concrete", {0, -kCorridor, kFloorHeight}, {x, y, kFloorHeight + kSlab}},
      {"outer west", "concrete", {-kSlab, -kCorridor, 0}, {0, y, kFloorHeight}},
      {"outer east", "concrete", {x, -kCorridor, 0}, {x + kSlab, y, kFloorHeight}},
      {"outer south", "concrete", {0, -kCorridor - kSlab, 0}, {x, -kCorridor, kFloorHeight}}};
  for (std::size_t room = 0; room < rooms; ++room) {
    const std::size_t row = room / columns;
    const Vec3d corner{static_cast<double>(room % columns) * kRoomX,
                       static_cast<double>(row) * (kRoomY + kCorridor),
                       0};
    for (std::size_t i = 0; i < in_room && boxes.size() < count; ++i) {
      boxes.push_back(moved(room_boxes()[i], corner, room));
    }
  }
  return scene_of_boxes(boxes);
}

Vec3d office_access_point() { return {3.6, 0.6, 2.3}; }
Vec3d office_device() { return {1.1, 2.1, 1.1}; }
Vec3d office_corridor() { return {2.2, -1.1, 1.3}; }

}  // namespace rayloc::test
