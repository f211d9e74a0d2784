#include "daemon/lab/draw/room_map.h"

#include <string>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/site/plan/palette.h"
#include "tests/support/scenes.h"

namespace rayloc::draw::room_map_test {
namespace {

RoomMap map_of(const Scene& scene) {
  RoomMap map;
  map.scene = &scene;
  map.title = "residuals";
  map.value_name = "correlation";
  map.colour = share_colour;
  return map;
}

std::vector<Circle> circles(const Drawing& drawing) {
  std::vector<Circle> found;
  for (const Shape& shape : drawing.shapes) {
    if (const auto* circle = std::get_if<Circle>(&shape)) {
      found.push_back(*circle);
    }
  }
  return found;
}

class RoomMapTest : public ::testing::Test {
 protected:
  RoomMapTest()
      : scene_(test::make_scene({{"table", test::box_mesh({-2, -1, 0}, {2, 1, 0.7})}},
                                test::kConcrete)),
        map_(map_of(*scene_)) {}

  std::shared_ptr<const Scene> scene_;
  RoomMap map_;
};

TEST_F(RoomMapTest, ColoursDotsByTheirValue) {
  map_.dots = {
      {{-1.0, 0.0, 1.0}, 0.0, false}, {{1.0, 0.5, 1.0}, 1.0, true}, {{0, 0, 1}, 9.0, false}};
  const auto dots = circles(draw_room_map(map_));
  ASSERT_EQ(dots.size(), 3U);
  EXPECT_EQ(dots[0].fill, share_colour(0.0));
  EXPECT_EQ(dots[1].fill, share_colour(1.0));
  EXPECT_EQ(dots[2].fill, share_colour(1.0));  // the end of the scale
  EXPECT_EQ(dots[1].outline->colour, kInk);
  EXPECT_NE(dots[0].outline->colour, kInk);
  EXPECT_LT(dots[0].centre.x, dots[1].centre.x);
  EXPECT_GT(dots[0].centre.y, dots[1].centre.y);  // y of the room runs up
}

TEST_F(RoomMapTest, CellsAreSquaresUnderTheLinesOfTheRoom) {
  map_.cells = {{{-1.0, 0.0, 1.0}, 0.5, 0.0}, {{1.0, 0.0, 1.0}, 0.5, 1.0}};
  const Drawing drawing = draw_room_map(map_);
  std::vector<std::size_t> squares;
  std::size_t last_line = 0;
  for (std::size_t i = 0; i < drawing.shapes.size(); ++i) {
    const auto* polygon = std::get_if<Polygon>(&drawing.shapes[i]);
    if (polygon != nullptr && polygon->corners.size() == 4 &&
        (polygon->fill == share_colour(0.0) || polygon->fill == share_colour(1.0))) {
      squares.push_back(i);
    }
    if (std::holds_alternative<Line>(drawing.shapes[i])) {
      last_line = i;
    }
  }
  ASSERT_EQ(squares.size(), 2U);
  EXPECT_GT(last_line, squares.back());
  const auto& west = std::get<Polygon>(drawing.shapes[squares[0]]);
  const auto& east = std::get<Polygon>(drawing.shapes[squares[1]]);
  EXPECT_LT(west.corners[1].x, east.corners[0].x);
}

TEST_F(RoomMapTest, NamesReplaceTheScale) {
  map_.names = {{"north", share_colour(0.2)}, {"south", share_colour(0.8)}};
  std::vector<std::string> texts;
  for (const Shape& shape : draw_room_map(map_).shapes) {
    if (const auto* text = std::get_if<Text>(&shape)) {
      texts.push_back(text->text);
    }
  }
  EXPECT_THAT(texts, ::testing::IsSupersetOf({"north", "south", "correlation"}));
  EXPECT_THAT(texts, ::testing::Not(::testing::Contains("0.25")));
}

TEST_F(RoomMapTest, ColoursLinesByTheirValue) {
  map_.colour = [](double share) { return signed_colour(2.0 * share - 1.0); };
  map_.lowest = -0.01;
  map_.highest = 0.01;
  map_.lines = {{{-2, -1, 0}, {2, -1, 0}, -0.01}};
  bool found = false;
  for (const Shape& shape : draw_room_map(map_).shapes) {
    const auto* line = std::get_if<Line>(&shape);
    found = found || (line != nullptr && line->pen.colour == signed_colour(-1.0));
  }
  EXPECT_TRUE(found);
}

TEST_F(RoomMapTest, KeepsEverythingOnThePage) {
  map_.dots = {{{-2.0, -1.0, 1.0}, 0.0, false}, {{2.0, 1.0, 1.0}, 1.0, false}};
  const Drawing drawing = draw_room_map(map_);
  for (const Circle& dot : circles(drawing)) {
    EXPECT_GT(dot.centre.x, 0.0);
    EXPECT_LT(dot.centre.x, drawing.width);
    EXPECT_GT(dot.centre.y, 0.0);
    EXPECT_LT(dot.centre.y, drawing.height);
  }
}

}  // namespace
}  // namespace rayloc::draw::room_map_test
