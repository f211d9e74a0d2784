#include "daemon/site/scene/room_plan.h"

#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/daemon/site/scene/room_text.h"

namespace rayloc::room_plan_test {
namespace {

using testing::kRoomFile;
using testing::room_errors;
using testing::room_text;

TEST(RoomPlan, IsReadWhole) {
  const auto plan = parse_room_plan(room_text(), kRoomFile);
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_EQ(plan->name, "office");
  EXPECT_EQ(plan->lower, (Vec3d{-1, 0, 0}));
  EXPECT_EQ(plan->upper, (Vec3d{4.2, 3.4, 2.7}));
  EXPECT_EQ(
      plan->side_material,
      (std::array<std::string, 6>{
          "concrete", "ceiling_board", "plasterboard", "plasterboard", "plasterboard", "outer"}));
  ASSERT_EQ(plan->openings.size(), 2U);
  EXPECT_EQ(plan->openings[0].wall, RoomSide::kEast);
  EXPECT_EQ(plan->openings[0].lower, (std::array{0.55, 0.0}));
  EXPECT_EQ(plan->openings[0].upper, (std::array{1.45, 2.0}));
  EXPECT_EQ(plan->openings[1].material, "");
  ASSERT_EQ(plan->boxes.size(), 2U);
  EXPECT_NEAR(plan->boxes[0].yaw, std::numbers::pi / 6.0, 1e-15);
  EXPECT_EQ(plan->boxes[1].size.x, 0.0);
}

TEST(RoomPlan, KeepsTheMaterialsInUseByName) {
  const auto plan = parse_room_plan(room_text(), kRoomFile);
  ASSERT_TRUE(plan) << plan.error().message;
  std::vector<std::string> names;
  for (const StatedMaterial& material : plan->materials) {
    names.push_back(material.name + "/" + material.itu);
  }
  EXPECT_EQ(names,
            (std::vector<std::string>{"ceiling_board/ceiling_board",
                                      "concrete/concrete",
                                      "cork/",
                                      "outer/brick",
                                      "plasterboard/plasterboard",
                                      "wood/wood"}));
  EXPECT_EQ(plan->materials[1].thickness, kDefaultThickness);
  EXPECT_EQ(plan->materials[2].relative_permittivity, 1.8);
  EXPECT_EQ(plan->materials[3].thickness, 0.24);
}

TEST(RoomPlan, FiveLinesAreEnough) {
  const auto plan = parse_room_plan(
      "name = \"x\"\nsize = [4, 3, 2.5]\nfloor = \"concrete\"\nceiling = \"concrete\"\nwalls = "
      "\"brick\"\n",
      kRoomFile);
  ASSERT_TRUE(plan) << plan.error().message;
  EXPECT_EQ(plan->lower, (Vec3d{0, 0, 0}));
  EXPECT_EQ(plan->carrier.grid.centre_hz, 5.19e9);
  EXPECT_EQ(plan->carrier.grid.size(), 114U);
}

TEST(RoomPlan, FourWallsOneByOneNeedNoCommonMaterial) {
  EXPECT_EQ(room_errors(room_text("walls = \"plasterboard\"",
                                  "wall_west = \"plasterboard\"\nwall_east = \"brick\"\n"
                                  "wall_south = \"brick\"")),
            "");
  EXPECT_EQ(room_errors(room_text("walls = \"plasterboard\"", "wall_west = \"plasterboard\"")),
            "office.toml:1:1: the file lacks 'walls'; add, for example: walls = \"plasterboard\"");
}

TEST(RoomPlan, AccessPointsAreThoseOfASite) {
  const std::string access_point =
      "[[access_point]]\nid = \"ap1\"\nposition = [0, 1, 2.2]\n[[access_point.antenna]]\n"
      "core = 0\noffset = [0, 0, 0]\n";
  const auto plan = parse_room_plan(room_text() + access_point, kRoomFile);
  ASSERT_TRUE(plan) << plan.error().message;
  ASSERT_EQ(plan->access_points.size(), 1U);
  EXPECT_EQ(plan->access_points[0].array.pose.position, (Vec3d{0, 1, 2.2}));
  const std::string outside = testing::edited_text(access_point, "2.2]", "3.5]");
  EXPECT_EQ(room_errors(room_text() + outside),
            "office.toml:40:12: 'position' has z = 3.5 m, outside [bounds] z = [0, 2.7]; write "
            "metres in the coordinates of the room");
}

TEST(RoomPlan, EachMistakeHasAPositionAndARemedy) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {room_text("walls = \"plasterboard\"", "wals = \"plasterboard\""),
       "office.toml:1:1: the file lacks 'walls'; add, for example: walls = \"plasterboard\"\n"
       "office.toml:6:1: unknown key 'wals'; did you mean 'walls'?\n"
       "office.toml:30:1: material 'plasterboard' is not used; name it in a wall, floor, ceiling, "
       "opening or box, or remove it"},
      {room_text("floor = \"concrete\"", "floor = \"concret\""),
       "office.toml:4:9: 'floor': neither ITU-R P.2040-4 nor [materials] has 'concret'; did you "
       "mean 'concrete'?"},
      {room_text("material = \"cork\"", "material = \"crok\""),
       "office.toml:27:12: 'material': neither ITU-R P.2040-4 nor [materials] has 'crok'; did you "
       "mean 'cork'?"},
      {room_text("material = \"cork\"", "material = \"wood\""),
       "office.toml:35:1: material 'cork' is not used; name it in a wall, floor, ceiling, opening "
       "or box, or remove it"},
      {room_text("\"brick\"", "\"floorboard\""),
       "office.toml:33:7: material 'outer': ITU-R P.2040-4 states 'floorboard' for 50 to 100 GHz, "
       "not for 5.19 GHz; state relative_permittivity and conductivity instead"},
      {room_text("itu = \"brick\"", "itu = \"brick\"\nconductivity = 0.1"),
       "office.toml:32:1: material 'outer' states 'itu' and numbers of its own; write one or the "
       "other\n"
       "office.toml:32:1: [materials.outer] lacks 'relative_permittivity'; add, for example: "
       "relative_permittivity = 2.7"},
      {room_text("size = [5.2, 3.4, 2.7]", "size = [5200, 3400, 2700]"),
       "office.toml:2:8: 'size' has 5200 m; write the inside along x, y and z in metres, 0.1 to "
       "1000 each"},
      {room_text("centre = [1.0, 1.0]", "centre = [1.0, 0.9]"),
       "office.toml:11:10: the opening is at [-0.1, 1.9] m in height, its wall at [0, 2.7] m; "
       "correct 'centre' or 'size'"},
      {room_text("wall = \"south\"\ncentre = [2.5, 1.05]", "wall = \"east\"\ncentre = [1.5, 1.05]"),
       "office.toml:17:10: the opening overlaps the opening 'door'"},
      {room_text("wall = \"south\"", "wall = \"sout\""),
       "office.toml:16:8: 'sout' is no value of 'wall'; did you mean 'south'?"},
      {room_text("name = \"table\"", "name = \"door\""),
       "office.toml:20:8: a second object 'door'; give each its own name"},
      {room_text("name = \"table\"", "name = \"my/table\""),
       "office.toml:20:8: 'name' is 'my/table'; write letters, digits, '-' and '_' only"},
      {room_text("centre = [2.6, 1.7, 0.8]", "centre = [2.6, 0.5, 0.8]"),
       "office.toml:28:10: the box reaches 0.1 m beyond the wall_south; correct 'centre' or "
       "'size'"},
      {room_text("size = [0, 1.2, 1.6]", "size = [0, 1.2, 0]"),
       "office.toml:29:8: 'size' is the length along the box's x, y and z: write 0.001 to 1000 m; "
       "one of the three may be 0, for a sheet"},
  };
  for (const auto& [text, errors] : cases) {
    EXPECT_EQ(room_errors(text), errors);
  }
}

TEST(RoomPlan, FurnitureMayTouchTheWall) {
  // 0.1 + 0.2 is more than 0.3: rounding is no mistake of the plan's.
  EXPECT_EQ(room_errors("name = \"x\"\nsize = [0.3, 3, 3]\nfloor = \"wood\"\nceiling = \"wood\"\n"
                        "walls = \"wood\"\n[[box]]\nname = \"b\"\nmaterial = \"wood\"\n"
                        "centre = [0.2, 1, 1]\nsize = [0.2, 0.2, 0.2]\n"),
            "");
}

}  // namespace
}  // namespace rayloc::room_plan_test
