#include "daemon/lab/experiment/controls.h"

#include <cmath>
#include <memory>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/support/synthetic_room.h"

namespace rayloc::controls_test {
namespace {

std::shared_ptr<const RoomModel> room() {
  static const auto kRoom = std::make_shared<const RoomModel>(test::make_room());
  return kRoom;
}

StudyPoint point_at(const Vec3d& place, unsigned seed) {
  return {place, test::frames_at(*room(), place, {.seed = seed})};
}

// The message of a control that cannot be made; empty if it is made.
std::string refusal(std::string_view name,
                    const StudyLayout& layout,
                    std::shared_ptr<const RoomModel> model = room()) {
  const auto made = make_control(name, std::move(model), layout, true, 1);
  return made ? "" : made.error().message;
}

TEST(Controls, RefuseALayoutWithoutTheirInput) {
  const StudyLayout bare;
  EXPECT_EQ(refusal("centre", bare), "");
  EXPECT_NE(refusal("nearest", bare).find("no survey"), std::string::npos);
  EXPECT_NE(refusal("level", bare).find("no survey"), std::string::npos);
  EXPECT_NE(refusal("start", bare).find("no person walks"), std::string::npos);
  StudyLayout people;
  people.transmitter.emplace();
  EXPECT_NE(refusal("level", people).find("do not locate people"), std::string::npos);
  EXPECT_NE(refusal("oracle", people).find("no direct path"), std::string::npos);
  RoomModel odd = *room();
  odd.grid.tone_index = {1, 2, 3, 5, 8};
  EXPECT_NE(refusal("oracle", bare, std::make_shared<const RoomModel>(odd)).find("equal steps"),
            std::string::npos);
}

TEST(Controls, AreWhatTheirNamesState) {
  StudyLayout layout;
  for (const double x : {-0.6, 0.0, 0.6}) {
    layout.survey.push_back(point_at({x, 0.3, 1.2}, 1));
  }
  const StudyPoint again = point_at({0.6, 0.3, 1.2}, 2);
  const auto place_of = [&](std::string_view name) {
    return *(*make_control(name, room(), layout, true, 1))(again, 0).position;
  };
  EXPECT_EQ(place_of("nearest"), layout.survey[2].position);
  EXPECT_EQ(place_of("centre"), 0.5 * (room()->bounds_min + room()->bounds_max));
  // The oracle has the true range in plan.
  const Vec3d& from = room()->access_points[0].array.pose.position;
  const Vec3d oracle = place_of("oracle");
  EXPECT_NEAR(std::hypot(oracle.x - from.x, oracle.y - from.y),
              std::hypot(again.position.x - from.x, again.position.y - from.y),
              1e-9);
}

}  // namespace
}  // namespace rayloc::controls_test
