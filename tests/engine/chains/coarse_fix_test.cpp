#include "engine/chains/coarse_fix.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "engine/likelihood/rotated_likelihood.h"
#include "engine/posterior/credible_region.h"
#include "tests/support/faulty_frames.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::coarse_fix_test {
namespace {

std::shared_ptr<const Localizer> localizer() {
  static const std::shared_ptr<const Localizer> kLocalizer = std::make_shared<const Localizer>(
      *Localizer::create(std::make_shared<const RoomModel>(test::make_room()), {}));
  return kLocalizer;
}

Vec3d place(int number) {
  std::mt19937 random(static_cast<unsigned>(number + 100));
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double x = 1.2 * uniform(random);
  return {x, 0.9 * uniform(random), 1.2};
}

// A burst of a device there, with each chain but the first of each access point rotated.
std::vector<CsiFrame> burst(int number, double turn) {
  auto frames = test::frames_at(
      localizer()->room(), place(number), {4, 30.0, static_cast<unsigned>(number + 1)});
  const auto& access_points = localizer()->room().access_points;
  for (std::size_t a = 0; a < access_points.size(); ++a) {
    for (std::size_t m = 1; m < access_points[a].rx_chains.size(); ++m) {
      test::turn_chain(
          frames, a, access_points[a].rx_chains[m], turn * static_cast<double>(1 + m + a));
    }
  }
  return frames;
}

// The states of the chains are a sixteenth of a turn apart, and all are equally probable.
TEST(CoarseFix, IsIndependentOfTheChainPhases) {
  constexpr double kStep = 2.0 * std::numbers::pi / 16.0;
  for (int i = 0; i < 5; ++i) {
    const LocationEstimate as_calibrated = locate_coarsely(*localizer(), burst(i, 0.0));
    const LocationEstimate rotated = locate_coarsely(*localizer(), burst(i, kStep));
    ASSERT_TRUE(as_calibrated.position && rotated.position) << i << rotated.reason;
    EXPECT_NEAR(norm(*as_calibrated.position - *rotated.position), 0.0, 1e-3) << i;
    EXPECT_NEAR(as_calibrated.accuracy_m, rotated.accuracy_m, 1e-3) << i;
  }
}

// They are wider than those of chains that are known, and no wider than the room.
TEST(CoarseFix, ItsRegionsHoldThePlaces) {
  constexpr int kPlaces = 20;
  constexpr double kTurn = 1.0;  // [rad]
  int held = 0;
  double width = 0.0;
  double width_of_known = 0.0;
  for (int i = 0; i < kPlaces; ++i) {
    const LocationEstimate coarse = locate_coarsely(*localizer(), burst(i, kTurn));
    ASSERT_TRUE(coarse.position) << i << coarse.reason;
    held += region_reaching(coarse, place(i)).value_or(1.0) < 0.95 ? 1 : 0;
    width += coarse.accuracy_m / kPlaces;
    width_of_known += localizer()->locate(burst(i, 0.0)).accuracy_m / kPlaces;
    EXPECT_EQ(coarse.access_points_used, localizer()->room().access_points.size());
  }
  EXPECT_GE(held, kPlaces - 2);
  EXPECT_GT(width, 2.0 * width_of_known);
  EXPECT_LT(width, std::hypot(3.0, 2.4));  // [m], of the room
}

// Frames of the first access point only.
std::vector<CsiFrame> of_first(std::vector<CsiFrame> frames) {
  std::erase_if(frames, [](const CsiFrame& frame) { return frame.access_point != 0; });
  return frames;
}

// Its regions are wide, and a burst that fits everywhere gives the reason.
TEST(CoarseFix, OneAccessPointIsEnough) {
  constexpr int kPlaces = 20;
  int located = 0;
  int held = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const LocationEstimate coarse = locate_coarsely(*localizer(), of_first(burst(i, 1.0)));
    if (!coarse.position) {
      EXPECT_NE(coarse.reason.find("flat"), std::string::npos) << i << coarse.reason;
      continue;
    }
    ++located;
    held += norm(*coarse.position - place(i)) < coarse.accuracy_m ? 1 : 0;
    EXPECT_LT(coarse.accuracy_m, std::hypot(3.0, 2.4)) << i;
    EXPECT_EQ(coarse.access_points_used, 1U);
  }
  EXPECT_GE(located, 3 * kPlaces / 4);
  EXPECT_GE(held, located - 2);
}

// With a belief in the right states the regions become smaller; wherever it is wrong, regions hold.
TEST(CoarseFix, UsesTheBeliefInTheStates) {
  constexpr int kPlaces = 10;
  const RotationGrid grid(3);
  std::vector<double> certain(grid.size());
  certain[0] = 1.0;
  const std::vector<std::vector<double>> beliefs(localizer()->room().access_points.size(), certain);
  double width = 0.0;
  double width_of_any = 0.0;
  int held_by_wrong = 0;
  for (int i = 0; i < kPlaces; ++i) {
    width += locate_coarsely(*localizer(), burst(i, 0.0), beliefs).accuracy_m;
    width_of_any += locate_coarsely(*localizer(), burst(i, 0.0)).accuracy_m;
    const LocationEstimate wrong =
        locate_coarsely(*localizer(), burst(i, 1.0), std::span(beliefs).first(1));
    ASSERT_TRUE(wrong.position) << i << wrong.reason;
    held_by_wrong += region_reaching(wrong, place(i)).value_or(1.0) < 0.95 ? 1 : 0;
  }
  EXPECT_LT(width, width_of_any);
  EXPECT_GE(held_by_wrong, kPlaces - 2);
}

TEST(CoarseFix, ReportsTheReasonForNoFix) {
  const LocationEstimate of_nothing = locate_coarsely(*localizer(), {});
  EXPECT_FALSE(of_nothing.position);
  EXPECT_EQ(of_nothing.reason, "no frames");
}

}  // namespace
}  // namespace rayloc::coarse_fix_test
