#include "daemon/lab/predict/prediction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "daemon/lab/predict/planned_room.h"
#include "daemon/lab/predict/prediction_report.h"
#include "daemon/lab/predict/proposals.h"
#include "daemon/site/scene/solid_around.h"
#include "tests/support/test_paths.h"

namespace rayloc::prediction_test {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::shared_ptr<const RoomModel> room_with(const std::vector<std::string>& access_points) {
  const auto site = load_site(test::data_path("/sites/meeting_room"));
  return std::make_shared<const RoomModel>(*planned_room(*site, {.access_points = access_points}));
}

TEST(Prediction, PlacesAreInTheRoomAndInNoSolid) {
  const auto room = room_with({"ap1"});
  const std::vector<Vec3d> places = predicted_places(*room, 0.5);
  EXPECT_GT(places.size(), 20U);
  for (const Vec3d& place : places) {
    EXPECT_GT(place.x, room->bounds_min.x);
    EXPECT_LT(place.y, room->bounds_max.y);
    EXPECT_FALSE(solid_around(*room->scene, place));
  }
}

TEST(Prediction, ThreeAccessPointsImproveOnOne) {
  const std::vector<Vec3d> places{{-0.9, 0.6, 1.2}, {0.6, -0.5, 1.2}, {1.1, 0.2, 1.2}};
  PredictionOptions options;
  options.draws = 4;
  options.frames = 2;
  std::vector<double> shares;
  options.progress = [&](double share) { shares.push_back(share); };
  const auto one = predict(room_with({"ap1"}), places, options);
  const auto three = predict(room_with({}), places, options);
  ASSERT_TRUE(one && three);
  EXPECT_LT(three->p90_m, one->p90_m);
  EXPECT_LT(three->median_m, 0.1);
  EXPECT_EQ(three->places.size(), places.size());
  EXPECT_EQ(three->places[0].error.size(), 4U);
  EXPECT_EQ(shares.front(), 0.0);
  EXPECT_EQ(shares.back(), 1.0);
}

TEST(Prediction, IsTheSameOfTheSameSeed) {
  const auto room = room_with({"ap2"});
  const std::vector<Vec3d> places{{-0.9, 0.6, 1.2}};
  const auto first = predict(room, places, {.draws = 2});
  const auto again = predict(room, places, {.draws = 2});
  const auto other = predict(room, places, {.draws = 2, .seed = 2});
  ASSERT_TRUE(first && again && other);
  EXPECT_EQ(first->places[0].error, again->places[0].error);
  EXPECT_NE(first->places[0].error, other->places[0].error);
}

TEST(Proposals, HaveNoDistancesOfAntennasThatAreNoRow) {
  RoomModel room = *room_with({"ap1"});
  room.access_points[0].array.element_offset[1].z = 0.05;
  const auto found = proposals(room, {{-0.9, 0.6, 1.2}}, {.draws = 1}, {});
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->size(), 1U);
  EXPECT_EQ(found->front().what, "as it is");
}

TEST(ConfusedPlaces, CountsConfusedPlaces) {
  Prediction prediction;
  prediction.places.push_back({{0, 0, 1},
                               {0.1, 2.0, 2.1, kNever},
                               {{0.1, 0, 1}, {2, 0, 1}, {2.1, 0, 1}, {kNone, kNone, kNone}}});
  prediction.places.push_back({{5, 5, 1}, {1.0, 0.0}, {{5, 6, 1}, {5, 5, 1}}});
  const auto found = confused_places(prediction, 5);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].count, 2U);
  EXPECT_EQ(found[0].draws, 4U);
  EXPECT_EQ(found[0].taken_for.x, 2.0);
  EXPECT_EQ(found[1].place.x, 5.0);
  EXPECT_EQ(confused_places(prediction, 1).size(), 1U);
  EXPECT_EQ(another_place_share(prediction.places[0]), 0.75);
  EXPECT_EQ(median_error(prediction.places[1]), 1.0);
}

}  // namespace
}  // namespace rayloc::prediction_test
