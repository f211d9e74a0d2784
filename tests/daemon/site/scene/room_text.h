// A complete plan of a room for tests, and ways to change it: line numbers stay those of the text.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "daemon/site/scene/build_room.h"
#include "engine/scene/read/load_scene.h"
#include "tests/support/edited_text.h"
#include "tests/support/scenes.h"

namespace rayloc::testing {

inline const std::filesystem::path kRoomFile = "/plans/office.toml";

inline constexpr std::string_view kRoomText = R"(name = "office"
size = [5.2, 3.4, 2.7]
corner = [-1, 0, 0]
floor = "concrete"
ceiling = "ceiling_board"
walls = "plasterboard"
wall_north = "outer"
[[opening]]
name = "door"
wall = "east"
centre = [1.0, 1.0]
size = [0.9, 2.0]
material = "wood"
[[opening]]
name = "passage"
wall = "south"
centre = [2.5, 1.05]
size = [0.9, 2.1]
[[box]]
name = "table"
material = "wood"
centre = [1.0, 1.5, 0.73]
size = [1.8, 0.9, 0.05]
yaw_deg = 30
[[box]]
name = "screen"
material = "cork"
centre = [2.6, 1.7, 0.8]
size = [0, 1.2, 1.6]
[materials.plasterboard]
thickness_m = 0.0125
[materials.outer]
itu = "brick"
thickness_m = 0.24
[materials.cork]
relative_permittivity = 1.8
conductivity = 0.01
)";

// kRoomText with the first `from` replaced by `to`.
inline std::string room_text(std::string_view from = "", std::string_view to = "") {
  return edited_text(std::string(kRoomText), from, to);
}

// The errors of a plan, the folder taken from each line: "office.toml:3:1: ...".
inline std::string room_errors(std::string_view text) {
  const Expected<RoomPlan> plan = parse_room_plan(text, kRoomFile);
  return plan ? "" : without_folder(plan.error().message, kRoomFile);
}

// The scene of a plan, through its files; null after a failure.
inline std::shared_ptr<const Scene> plan_scene(const std::string& plan_text) {
  const auto plan = parse_room_plan(plan_text, kRoomFile);
  if (!plan) {
    ADD_FAILURE() << plan.error().message;
    return nullptr;
  }
  const auto files = scene_files(build_room(*plan));
  auto scene = parse_scene(files.at("scene.xml"),
                           "scene.xml",
                           {test::kCarrier, {}},
                           [&](const std::string& name) -> Expected<std::string> {
                             return files.contains(name) ? Expected<std::string>(files.at(name))
                                                         : bad_input(name + " was not written");
                           });
  if (!scene) {
    ADD_FAILURE() << scene.error().message;
    return nullptr;
  }
  return std::make_shared<const Scene>(*std::move(scene));
}

}  // namespace rayloc::testing
