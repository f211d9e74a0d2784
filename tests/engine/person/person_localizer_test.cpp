#include "engine/person/person_localizer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/person_in_room.h"

namespace rayloc::person_localizer_test {
namespace {

// Places of the synthetic room at least 0.3 m from walls and devices.
std::vector<TargetPosition> places() {
  std::vector<TargetPosition> result;
  for (const double x : {-0.95, -0.4, 0.05, 0.5, 0.9}) {
    for (const double y : {-0.55, -0.1, 0.35, 0.7}) {
      result.push_back({x + 0.037 * y, y + 0.029 * x});
    }
  }
  return result;
}

double error_of(const LocationEstimate& estimate, const TargetPosition& truth) {
  return std::hypot(estimate.position->x - truth.x, estimate.position->y - truth.y);
}

TargetBody wider_body() {
  TargetBody body = PersonModel{}.body;
  body.semi_axes = {0.18, 0.18};
  body.relative_permittivity = 49.0;
  return body;
}

class PersonLocalizerTest : public ::testing::Test {
 protected:
  static const std::shared_ptr<const RoomModel>& room() {
    static const auto kRoom = std::make_shared<const RoomModel>(test::make_room());
    return kRoom;
  }
  static const PersonLocalizer& localizer() {
    static const PersonLocalizer kLocalizer =
        *PersonLocalizer::create(room(), test::learn_reference(*room()), {});
    return kLocalizer;
  }
};

TEST_F(PersonLocalizerTest, FindsAPersonOfTheExpectedBuild) {
  int near = 0;
  int covered = 0;
  int suspects = 0;
  std::vector<double> errors;
  unsigned seed = 1;
  for (const TargetPosition& truth : places()) {
    const auto estimate = localizer().locate(
        test::frames_past(*room(), {truth}, PersonModel{}.body, {.count = 8, .seed = seed++}));
    ASSERT_TRUE(estimate.position) << estimate.reason;
    const bool is_suspect = std::any_of(
        estimate.warnings.begin(), estimate.warnings.end(), [](const std::string& warning) {
          return warning.find("beside the transmitter") != std::string::npos;
        });
    if (is_suspect) {  // it could have been moved
      EXPECT_TRUE(estimate.ambiguous);
      EXPECT_GE(estimate.residual_probability, 0.5);
      EXPECT_GT(estimate.accuracy_m, 1.0);
      ++suspects;
    }
    errors.push_back(error_of(estimate, truth));
    near += errors.back() < 0.08 ? 1 : 0;
    covered += errors.back() <= estimate.accuracy_m ? 1 : 0;
    EXPECT_EQ(estimate.access_points_used, 3U);
    EXPECT_EQ(estimate.position->z, 0.0);
  }
  std::nth_element(errors.begin(), errors.begin() + 10, errors.end());
  std::printf("one person: %d of 20 within 8 cm, median %.1f mm, %d regions hold the truth\n",
              near,
              1e3 * errors[10],
              covered);
  EXPECT_GE(near, 13);
  EXPECT_LT(errors[10], 0.015);  // where in a cell of 50 mm, not its middle
  EXPECT_GE(covered, 19);
  EXPECT_LE(suspects, 2);
}

TEST_F(PersonLocalizerTest, StatesAWiderRegionForABodyOfAnotherBuild) {
  int covered = 0;
  double sum = 0.0;
  unsigned seed = 1;
  for (const TargetPosition& truth : places()) {
    const auto estimate = localizer().locate(
        test::frames_past(*room(), {truth}, wider_body(), {.count = 8, .seed = seed++}));
    const bool inside = !estimate.position || error_of(estimate, truth) <= estimate.accuracy_m;
    covered += inside ? 1 : 0;
    sum += estimate.position ? error_of(estimate, truth) : 0.0;
  }
  std::printf(
      "body of 0.18 m instead of 0.165 m: %d of 20 regions hold the truth, mean error %.3f m\n",
      covered,
      sum / 20.0);
  EXPECT_GE(covered, 19);
}

TEST_F(PersonLocalizerTest, FindsNoPersonInTheEmptyRoom) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto estimate = localizer().locate(test::frames_past(
        *room(), {}, {}, {.count = 1 + static_cast<int>(seed % 8), .seed = seed}));
    EXPECT_FALSE(estimate.position) << seed;
    EXPECT_NE(estimate.reason.find("no person"), std::string::npos) << estimate.reason;
  }
}

// 20 cases: at most one may state a 95 % region that holds neither of the two.
TEST_F(PersonLocalizerTest, DoesNotStateAWrongPlaceForTwoPeople) {
  int wrong = 0;
  const auto all = places();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const TargetPosition& one = all[i];
    const TargetPosition& other = all[(i + 9) % all.size()];
    const auto estimate = localizer().locate(test::frames_past(
        *room(), {one, other}, PersonModel{}.body, {.count = 8, .seed = static_cast<unsigned>(i)}));
    if (estimate.position && error_of(estimate, one) > estimate.accuracy_m &&
        error_of(estimate, other) > estimate.accuracy_m) {
      ++wrong;
    }
  }
  std::printf("two people: %d of %zu regions hold neither\n", wrong, all.size());
  EXPECT_LE(wrong, 1);
}

TEST_F(PersonLocalizerTest, GoesOnWithoutABlockedAccessPoint) {
  int wrong = 0;
  int fixes = 0;
  int warned = 0;
  unsigned seed = 1;
  for (const TargetPosition& truth : places()) {
    auto channels = test::channels_past(*room(), {truth}, PersonModel{}.body);
    // An object blocks the second: its channel is that of another transmitter.
    channels[1] = test::channel_at(*room(), room()->access_points[1], {0.3, 0.2, 0.7});
    const auto estimate =
        localizer().locate(test::frames_of(*room(), channels, {.count = 8, .seed = seed++}));
    fixes += estimate.position ? 1 : 0;
    wrong += estimate.position && error_of(estimate, truth) > estimate.accuracy_m ? 1 : 0;
    warned += estimate.warnings.empty() ? 0 : 1;
  }
  std::printf("blocked access point: %d fixes of 20, %d warned, %d regions miss the truth\n",
              fixes,
              warned,
              wrong);
  EXPECT_LE(wrong, 1);
  EXPECT_GE(fixes, 15);
}

TEST_F(PersonLocalizerTest, ContinuesWithTheRemainingAccessPoints) {
  const TargetPosition truth = places()[7];
  auto channels = test::channels_past(*room(), {truth}, PersonModel{}.body);
  channels[0].clear();
  const auto estimate = localizer().locate(test::frames_of(*room(), channels, {.count = 8}));
  ASSERT_TRUE(estimate.position) << estimate.reason;
  EXPECT_EQ(estimate.access_points_used, 2U);
  EXPECT_LT(error_of(estimate, truth), 0.1);
}

TEST_F(PersonLocalizerTest, ReportsTheReasonForNoFix) {
  EXPECT_EQ(localizer().locate({}).reason, "no frames");
  auto frames = test::frames_past(*room(), {}, {}, {.count = 1});
  for (CsiFrame& frame : frames) {
    frame.access_point = 7;
  }
  EXPECT_NE(localizer().locate(frames).reason.find("no access point"), std::string::npos);
}

TEST_F(PersonLocalizerTest, GivesTheSameBytesAgain) {
  const auto frames = test::frames_past(*room(), {{0.2, 0.3}}, PersonModel{}.body);
  const auto first = localizer().locate(frames);
  const auto second = localizer().locate(frames);
  ASSERT_TRUE(first.position);
  EXPECT_EQ(first.position->x, second.position->x);
  EXPECT_EQ(first.accuracy_m, second.accuracy_m);
  EXPECT_EQ(first.loss, second.loss);
}

TEST(PersonLocalizer, RefusesAReferenceThatDoesNotFit) {
  const auto room = std::make_shared<const RoomModel>(test::make_room());
  PersonReference reference = test::learn_reference(*room);
  reference.links[0].empty.pop_back();
  const auto other_tones = PersonLocalizer::create(room, reference, {});
  ASSERT_FALSE(other_tones);
  EXPECT_NE(other_tones.error().message.find("rayloc reference"), std::string::npos);
  reference.links.clear();
  EXPECT_FALSE(PersonLocalizer::create(room, reference, {}));
}

}  // namespace
}  // namespace rayloc::person_localizer_test
