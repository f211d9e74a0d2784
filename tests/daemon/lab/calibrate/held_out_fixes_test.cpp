#include "daemon/lab/calibrate/held_out_fixes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "tests/support/synthetic_room.h"

namespace rayloc::held_out_fixes_test {
namespace {

constexpr int kPoints = 16;

// A room without errors of its model, and the frames of a device received in it.
struct Recorded {
  std::shared_ptr<const RoomModel> room;
  std::vector<Vec3d> places;
  std::vector<std::vector<CsiFrame>> frames;  // at each place
};

Recorded record() {
  RoomModel room = test::make_room();
  for (RoomAccessPoint& ap : room.access_points) {
    ap.error.plan_tolerance = 0.001;
    ap.error.diffuse = 0.005;
  }
  Recorded result{std::make_shared<const RoomModel>(std::move(room)), {}, {}};
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < kPoints; ++i) {
    const double x = 1.2 * uniform(random);
    result.places.push_back({x, 0.8 * uniform(random), 1.2});
    result.frames.push_back(test::frames_at(
        *result.room, result.places.back(), {4, 30.0, static_cast<unsigned>(i + 1)}));
  }
  return result;
}

const Recorded& recorded() {
  static const Recorded kRecorded = record();
  return kRecorded;
}

// The results for each tried exponent, with points whose stated positions have an error of `survey`
// [m] on the x and y axes.
std::vector<HeldOutFixes> fit_all(double survey, double survey_sigma) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<HeldOutPoint> points;
  for (std::size_t i = 0; i < recorded().places.size(); ++i) {
    const double x = survey * normal(random);
    points.push_back(
        {recorded().places[i] + Vec3d{x, survey * normal(random), 0.0}, recorded().frames[i]});
  }
  return fit_certainty_of(recorded().room, points, survey_sigma).value();
}

HeldOutFixes fit(double survey, double survey_sigma) {
  return fit_all(survey, survey_sigma).back();
}

TEST(HeldOutFixes, PositionsOfARoomThatIsAsItsModelAreStatedToMillimetres) {
  const HeldOutFixes fixes = fit(0.0, 0.0);
  EXPECT_EQ(fixes.fixes, static_cast<std::size_t>(kPoints));
  EXPECT_LT(fixes.median_error_m.value(), 0.01);
  EXPECT_LE(fixes.sigma_floor, 0.007);
}

// Regions contain the position as often as stated, up to chance. With several access points the
// exponent is at most 0.8: an error of the map affects all of them.
TEST(HeldOutFixes, TheExponentIsNotAboveTheModelAndItsRegionsHonest) {
  const HeldOutFixes fixes = fit(0.01, 0.01);
  EXPECT_LE(fixes.likelihood_exponent, 0.8);
  EXPECT_LT(fixes.dishonesty, 3.9);  // calibrated regions are below it in 99 of 100 cases
  // With wrong positions of the points, the regions are wrong at the highest exponent.
  const std::vector<HeldOutFixes> displaced = fit_all(0.3, 0.0);
  const auto sure = std::max_element(
      displaced.begin(), displaced.end(), [](const HeldOutFixes& a, const HeldOutFixes& b) {
        return a.likelihood_exponent < b.likelihood_exponent;
      });
  EXPECT_EQ(sure->likelihood_exponent, 0.8);
  EXPECT_GT(sure->dishonesty, 8.0);
  EXPECT_LT(displaced.back().likelihood_exponent, 0.2);
}

// The stated error of the survey does not count as an error of the fixes.
TEST(HeldOutFixes, ErrorsOfTheSurveyDoNotWidenTheRegions) {
  EXPECT_GE(fit(0.02, 0.0).sigma_floor, 0.014);
  EXPECT_LE(fit(0.02, 0.02).sigma_floor, 0.01);
}

// A survey at two heights gives more information on the room; a fix assumes one height.
TEST(HeldOutFixes, PointsAtOtherHeightsDoNotCount) {
  std::vector<HeldOutPoint> points;
  for (std::size_t i = 0; i < recorded().places.size(); ++i) {
    points.push_back({recorded().places[i], recorded().frames[i]});
    // Fixes of these frames are right, and they would be a metre off this point.
    points.push_back({recorded().places[i] + Vec3d{1.0, 0.0, 0.4}, recorded().frames[i]});
  }
  const HeldOutFixes fixes = fit_certainty_of(recorded().room, points, 0.0).value().back();
  EXPECT_EQ(fixes.points, static_cast<std::size_t>(kPoints));
  EXPECT_LT(fixes.median_error_m.value(), 0.01);
  EXPECT_LE(fixes.sigma_floor, 0.007);
  const std::vector<HeldOutPoint> displaced{points[1], points[3]};
  const HeldOutFixes none = fit_certainty_of(recorded().room, displaced, 0.0).value().back();
  EXPECT_EQ(none.points, 0U);
  EXPECT_FALSE(none.median_error_m);
  EXPECT_EQ(none.sigma_floor, recorded().room->sigma_floor);
}

TEST(HeldOutFixes, FewPointsLeaveTheCertaintyUnchanged) {
  const HeldOutPoint alone{recorded().places.front(), recorded().frames.front()};
  const auto fixes = fit_certainty_of(recorded().room, std::vector(3, alone), 0.005);
  ASSERT_TRUE(fixes);
  ASSERT_EQ(fixes->size(), 1U);
  EXPECT_EQ(fixes->back().likelihood_exponent, recorded().room->likelihood_exponent);
  EXPECT_EQ(fixes->back().sigma_floor, recorded().room->sigma_floor);
}

}  // namespace
}  // namespace rayloc::held_out_fixes_test
