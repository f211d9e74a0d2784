// Rooms of any outline: their plan, their sheets, their paths.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "daemon/site/scene/build_room.h"
#include "daemon/site/scene/room_site.h"
#include "engine/base/constants.h"
#include "engine/trace/path_tracer.h"
#include "tests/daemon/site/scene/room_text.h"
#include "tests/support/scenes.h"

namespace rayloc::room_outline_test {
namespace {

using testing::edited_text;
using testing::plan_scene;
using testing::room_errors;

// An L, its corner cut off: six metres by four, and a niche.
const std::string kOutlined = R"(name = "office"
outline = [[0, 0], [6, 0], [6, 4], [4, 4], [4, 2], [0, 2]]
height = 2.7
floor = "concrete"
ceiling = "ceiling_board"
walls = "plasterboard"
wall_2 = "glass"
[[partition]]
name = "partition"
from = [4, 2]
to = [6, 2]
material = "brick"
height = 2.0
[[opening]]
name = "door"
wall = "partition"
centre = [1.0, 0.9]
size = [0.8, 1.8]
material = "wood"
[[opening]]
name = "passage"
wall = "wall_1"
centre = [5.5, 1.0]
size = [0.8, 2.0]
[[box]]
name = "table"
material = "wood"
centre = [2, 1, 0.73]
size = [1.8, 0.9, 0.05]
)";

std::string outlined(std::string_view from = "", std::string_view to = "") {
  return edited_text(kOutlined, from, to);
}

const std::string kTwoRooms = R"(name = "flat"
height = 2.5
floor = "wood"
ceiling = "plasterboard"
walls = "brick"
[[room]]
name = "hall"
outline = [[0, 0], [2, 0], [2, 3], [0, 3]]
[[room]]
name = "study"
outline = [[2, 1], [5, 1], [5, 3], [2, 3]]
height = 3.0
floor = "concrete"
wall_4 = "glass"
)";

// The ceiling rises from 1 m over the wall of x = 0 to 3 m at x = 2, then is flat.
const std::string kAttic = R"(name = "attic"
outline = [[0, 0], [4, 0], [4, 3], [0, 3]]
height = 3.0
floor = "wood"
ceiling = "plasterboard"
walls = "brick"
[[slope]]
from = [0, 0, 1]
to = [0, 3, 1]
through = [2, 0, 3]
)";

double area_of(const Scene& scene, const std::string& name) {
  double area = 0.0;
  for (std::uint32_t i = 0; i < scene.surfaces().size(); ++i) {
    area += scene.objects()[scene.owner(i).object].name == name ? scene.surfaces()[i].area() : 0.0;
  }
  return area;
}

TEST(RoomOutline, HasTheSheetsOfThePlan) {
  const auto scene = plan_scene(kOutlined);
  ASSERT_NE(scene, nullptr);
  EXPECT_NEAR(area_of(*scene, "floor"), 16.0, 1e-9);
  EXPECT_NEAR(area_of(*scene, "ceiling"), 16.0, 1e-9);
  EXPECT_NEAR(area_of(*scene, "wall_1"), 6 * 2.7 - 0.8 * 2.0, 1e-9);
  EXPECT_NEAR(area_of(*scene, "wall_2"), 4 * 2.7, 1e-9);
  EXPECT_NEAR(area_of(*scene, "wall_4"), 2 * 2.7, 1e-9);
  EXPECT_NEAR(area_of(*scene, "partition"), 2 * 2.0 - 0.8 * 1.8, 1e-9);
  EXPECT_NEAR(area_of(*scene, "door"), 0.8 * 1.8, 1e-9);
  // Floor, ceiling, six walls, the partition, its door, and the six faces of the table.
  EXPECT_EQ(scene->surfaces().size(), 2U + 6U + 1U + 1U + 6U);
  EXPECT_EQ(scene->dropped_triangles(), 0U);
  EXPECT_EQ(scene->bounds_max(), (Vec3d{6, 4, 2.7}));
}

TEST(RoomOutline, FacesInwardsForBothCornerOrders) {
  for (const char* outline :
       {"[[0, 0], [6, 0], [6, 4], [0, 4]]", "[[0, 4], [6, 4], [6, 0], [0, 0]]"}) {
    const auto scene =
        plan_scene(std::string("name = \"x\"\nheight = 3\nfloor = \"wood\"\nceiling = \"wood\"\n"
                               "walls = \"wood\"\noutline = ") +
                   outline + "\n");
    ASSERT_NE(scene, nullptr);
    ASSERT_EQ(scene->surfaces().size(), 6U);
    for (std::uint32_t i = 0; i < 6; ++i) {
      EXPECT_TRUE(scene->owner(i).one_facing);
      EXPECT_GT(distance(scene->surfaces()[i].plane(), Vec3d{3, 2, 1.5}), 0.0)
          << scene->objects()[scene->owner(i).object].name;
    }
  }
}

std::vector<double> path_lengths(const std::shared_ptr<const Scene>& scene) {
  std::vector<double> lengths;
  for (const Path& path :
       PathTracer(scene, {.max_depth = 2})
           .trace(Transmitter{{{1.1, 0.7, 1.2}, {}}}, Receiver{{{4.0, 2.9, 1.9}, {}}})) {
    lengths.push_back(path.tau * kSpeedOfLight);
  }
  std::sort(lengths.begin(), lengths.end());
  return lengths;
}

TEST(RoomOutline, FourCornersAreTheRoomOfThatSize) {
  const std::string materials = "floor = \"wood\"\nceiling = \"wood\"\nwalls = \"brick\"\n";
  const auto of_size =
      path_lengths(plan_scene("name = \"x\"\nsize = [5.2, 3.4, 2.7]\n" + materials));
  const auto of_outline = path_lengths(plan_scene(
      "name = \"x\"\nheight = 2.7\noutline = [[0, 0], [5.2, 0], [5.2, 3.4], [0, 3.4]]\n" +
      materials));
  ASSERT_EQ(of_size.size(), 25U);
  ASSERT_EQ(of_outline.size(), 25U);
  for (std::size_t i = 0; i < 25; ++i) {
    EXPECT_NEAR(of_size[i], of_outline[i], 1e-9);
  }
}

TEST(RoomOutline, RoomsShareTheirWall) {
  const auto scene = plan_scene(kTwoRooms);
  ASSERT_NE(scene, nullptr);
  // The hall's wall is as high as the study's ceiling where the study is behind it.
  EXPECT_NEAR(area_of(*scene, "hall_wall_2"), 3 * 2.5 + 2 * 0.5, 1e-9);
  EXPECT_EQ(area_of(*scene, "study_wall_4"), 0.0);
  EXPECT_NEAR(area_of(*scene, "study_wall_1"), 3 * 3.0, 1e-9);
  EXPECT_NEAR(area_of(*scene, "study_floor"), 6.0, 1e-9);
  EXPECT_EQ(scene->bounds_max(), (Vec3d{5, 3, 3}));
}

TEST(RoomOutline, CeilingsSlope) {
  const auto scene = plan_scene(kAttic);
  ASSERT_NE(scene, nullptr);
  EXPECT_NEAR(area_of(*scene, "ceiling"), 3 * std::sqrt(8.0) + 6.0, 1e-9);
  EXPECT_NEAR(area_of(*scene, "wall_1"), 2 * 2.0 + 2 * 3.0, 1e-9);
  EXPECT_NEAR(area_of(*scene, "wall_4"), 3.0, 1e-9);
  EXPECT_EQ(scene->surfaces().size(), 7U);
  for (std::uint32_t i = 0; i < 7; ++i) {
    EXPECT_GT(distance(scene->surfaces()[i].plane(), Vec3d{2, 1.5, 1}), 0.0);
  }
}

TEST(RoomOutline, GablesMeetAtTheRidge) {
  const auto scene =
      plan_scene(kAttic + "[[slope]]\nfrom = [4, 0, 1]\nto = [4, 3, 1]\nthrough = [3, 0, 2]\n");
  ASSERT_NE(scene, nullptr);
  EXPECT_NEAR(area_of(*scene, "ceiling"), 6 * std::sqrt(8.0), 1e-9);
  EXPECT_NEAR(area_of(*scene, "wall_1"), 8.0, 1e-9);
  EXPECT_EQ(scene->surfaces().size(), 7U);
}

TEST(RoomOutline, EachMistakeHasAPositionAndARemedy) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {outlined("[6, 4], [4, 4], [4, 2]", "[4, 4], [6, 4], [4, 2]"),
       "office.toml:2:11: 'outline' crosses itself: the wall from 6, 4 to 4, 2 meets an earlier "
       "one; "
       "list the corners in the order of the outline"},
      {outlined("[0, 2]]", "[0, 2], [0, 0]]"),
       "office.toml:2:11: 'outline' has the corner 0, 0 twice; the last corner is joined to the "
       "first without being written again"},
      {outlined("[[0, 0], [6, 0], [6, 4], [4, 4], [4, 2], [0, 2]]", "[[0, 0], [6, 0]]"),
       "office.toml:2:11: 'outline' has 2 corners; write 3 to 256, in the order of the outline"},
      {outlined("height = 2.7\n", "size = [5, 4, 3]\n"),
       "office.toml:1:1: the file lacks 'height'; add, for example: height = 2.7\n"
       "office.toml:3:8: 'size' is of a room with four walls; write it, or outlines"},
      {outlined("centre = [1.0, 0.9]\nsize = [0.8, 1.8]", "centre = [1.0, 0.9]\nsize = [2.2, 1.8]"),
       "office.toml:17:10: the opening is at [-0.1, 2.1] m along it, its wall at [0, 2] m; correct "
       "'centre' or 'size'"},
      {outlined("wall = \"wall_1\"", "wall = \"wall_9\""),
       "office.toml:22:8: 'wall_9' is no value of 'wall'; did you mean 'wall_1'?"},
      {outlined("wall_2 = ", "wall_7 = "),
       "office.toml:7:1: unknown key 'wall_7'; did you mean "
       "'wall_1'?"},
      {outlined("to = [6, 2]", "to = [6, 5]"),
       "office.toml:10:8: the wall is not within one room; correct 'from' or 'to'\n"
       "office.toml:16:8: 'partition' is no value of 'wall'; there are: wall_1, wall_2, wall_3, "
       "wall_4, wall_5, wall_6"},
      {outlined("centre = [2, 1, 0.73]", "centre = [3.5, 1.8, 0.73]"),
       "office.toml:28:10: the box is not within one room; correct 'centre' or 'size'"},
      {outlined("name = \"partition\"", "name = \"wall_3\""),
       "office.toml:9:8: a second object 'wall_3'; give each its own name\n"
       "office.toml:16:8: 'partition' is no value of 'wall'; there are: wall_1, wall_2, wall_3, "
       "wall_4, wall_5, wall_6, wall_3"},
      {edited_text(kTwoRooms, "[[2, 1], [5, 1]", "[[1, 1], [5, 1]"),
       "office.toml:11:11: the room lies in part over the room 'hall'; rooms may share a wall, not "
       "floor"},
      {edited_text(
           kTwoRooms, "[[2, 1], [5, 1], [5, 3], [2, 3]]", "[[-1, 1], [8, 1], [8, 1.2], [-1, 1.2]]"),
       "office.toml:11:11: the room lies in part over the room 'hall'; rooms may share a wall, not "
       "floor"},
      {edited_text(kTwoRooms, "floor = \"wood\"\n", ""),
       "office.toml:5:1: no 'floor' is stated, here or for the whole file; add, for example: floor "
       "= \"concrete\""},
      {kTwoRooms + "[[opening]]\nname = \"door\"\nwall = \"study_wall_4\"\ncentre = [1, 1]\nsize = "
                   "[0.8, 2]\n",
       "office.toml:18:10: there the wall is that of another room, 'hall_wall_2'; name that one in "
       "'wall'"},
      {edited_text(kAttic, "through = [2, 0, 3]", "through = [0, 1, 1]"),
       "office.toml:10:11: 'from', 'to' and 'through' are no three points of a ceiling: they lie "
       "on "
       "one line, or above one another"},
      {edited_text(kAttic, "through = [2, 0, 3]", "through = [2, 0, -3]"),
       "office.toml:7:1: the ceiling comes down below the floor at the corner 4, 0; correct the "
       "points of the slope, or end the outline where the ceiling meets the floor"},
      {kAttic + "[[opening]]\nname = \"hatch\"\nwall = \"wall_1\"\ncentre = [0.5, 1]\nsize = [0.8, "
                "1.6]\n",
       "office.toml:14:10: the opening reaches up to 1.8 m, its wall there to 1.1 m; correct "
       "'centre' or 'size'"},
      {kAttic +
           "[[box]]\nname = \"shelf\"\nmaterial = \"wood\"\ncentre = [0.5, 1, 1]\nsize = [0.8, "
           "1, 1]\n",
       "office.toml:14:10: the box reaches 0.4 m beyond the ceiling; correct 'centre' or 'size'"},
  };
  for (const auto& [text, errors] : cases) {
    EXPECT_EQ(room_errors(text), errors);
  }
}

TEST(RoomOutline, TheSiteProposesAnAccessPointWithinTheRoom) {
  // An L whose first corner is the inner one.
  const auto plan = parse_room_plan(
      "name = \"x\"\nheight = 2.3\nfloor = \"wood\"\nceiling = \"wood\"\nwalls = \"wood\"\n"
      "outline = [[4, 2], [0, 2], [0, 0], [6, 0], [6, 4], [4, 4]]\n",
      testing::kRoomFile);
  ASSERT_TRUE(plan) << plan.error().message;
  const std::string text = room_site(*plan);
  EXPECT_NE(text.find("\n# position = [0.3, 1.7, 2] "), std::string::npos) << text;
}

}  // namespace
}  // namespace rayloc::room_outline_test
