#include "tests/support/cloud_scene.h"

#include <utility>

#include "tests/support/scenes.h"

namespace rayloc::test {

RoomModel furnished_room() {
  RoomModel room = make_room();
  room.scene = make_scene({{"floor", box_mesh({-1.5, -1.2, -0.1}, {1.5, 1.2, 0.0})},
                           {"west", box_mesh({-1.6, -1.2, 0.0}, {-1.5, 1.2, 2.5})},
                           {"south", box_mesh({-1.5, -1.3, 0.0}, {1.5, -1.2, 2.5})},
                           {"cupboard", box_mesh({0.6, 0.2, -0.05}, {1.3, 0.8, 2.4})}},
                          kConcrete);
  room.device.height_sigma = 0.2;
  return room;
}

std::shared_ptr<const CloudRoom> cloud_room(RoomModel room, const LocalizerOptions& options) {
  auto localizer = std::make_shared<const Localizer>(
      *Localizer::create(std::make_shared<const RoomModel>(std::move(room)), options));
  auto space = std::make_shared<const FreeSpace>(make_free_space(*localizer));
  return make_cloud_room(std::move(localizer), std::move(space));
}

}  // namespace rayloc::test
