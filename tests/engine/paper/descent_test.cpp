#include "engine/paper/descent.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <vector>

namespace rayloc::paper::descent_test {
namespace {

const PlanBounds kBounds = {{-3.0, -2.0, 0.0}, {3.0, 2.0, 2.5}};
const Vec3d kBowl = {1.0, -0.5, 1.2};

LossInPlan bowl(const Vec3d& p) {
  const double x = p.x - kBowl.x;
  const double y = p.y - kBowl.y;
  return {x * x + y * y, 2.0 * x, 2.0 * y};
}

double distance(const Vec3d& a, const Vec3d& b) { return std::hypot(a.x - b.x, a.y - b.y); }

// Where the loss was asked for.
std::vector<Vec3d> asked(const DescentOptions& options, const Vec3d& start) {
  std::vector<Vec3d> places;
  std::mutex guard;
  std::mt19937_64 random(1);
  descend(
      [&](const Vec3d& p) {
        const std::lock_guard lock(guard);
        places.push_back(p);
        return bowl(p);
      },
      start,
      kBounds,
      options,
      random);
  return places;
}

TEST(PaperDescent, EndsInTheBowl) {
  std::mt19937_64 random(3);
  const Descent end = descend(bowl, {-1.0, 0.5, 1.2}, kBounds, {}, random);
  EXPECT_LT(distance(end.position, kBowl), 0.15);
  EXPECT_EQ(end.position.z, 1.2);
}

TEST(PaperDescent, DeviationShrinksBySchedule) {
  // softmax of five shares lies from 1/(1 + 4e) to e/(e + 4), so beta from 0.80 to 0.96.
  std::mt19937_64 random(3);
  const Descent end = descend(bowl, {0.0, 0.0, 1.2}, kBounds, {}, random);
  EXPECT_GT(end.deviation, 1.0 - 0.96 * 0.99);
  EXPECT_LT(end.deviation, 1.0 - 0.80 * 0.99 * 0.99);
}

TEST(PaperDescent, FixedDeviationStays) {
  DescentOptions options;
  options.is_deviation_fixed = true;
  options.variance = 0.25;
  std::mt19937_64 random(3);
  EXPECT_EQ(descend(bowl, {0.0, 0.0, 1.2}, kBounds, options, random).deviation, 0.5);
}

TEST(PaperDescent, AsksForSoManyPositionsAStep) {
  DescentOptions options;
  options.iterations = 7;
  options.positions = 4;
  EXPECT_EQ(asked(options, {0.0, 0.0, 1.2}).size(), 28U);
  options.is_smoothed = false;
  const auto places = asked(options, {0.0, 0.0, 1.2});
  ASSERT_EQ(places.size(), 7U);
  EXPECT_EQ(places.front(), (Vec3d{0.0, 0.0, 1.2}));  // the position itself
}

TEST(PaperDescent, WithoutSmoothingDrawsNothing) {
  DescentOptions options;
  options.is_smoothed = false;
  std::mt19937_64 random(3);
  const Descent end = descend(bowl, {0.0, 0.0, 1.2}, kBounds, options, random);
  EXPECT_EQ(random, std::mt19937_64(3));
  EXPECT_EQ(end.deviation, 0.0);
  EXPECT_LT(distance(end.position, kBowl), 0.1);
}

TEST(PaperDescent, SmoothingPassesADipThatTheGradientFallsInto) {
  // A bowl with ripples of 10 cm: slopes of up to 6 against 2 of the bowl a metre from its middle.
  const auto rippled = [](const Vec3d& p) {
    LossInPlan loss = bowl(p);
    const double k = 60.0;
    loss.value += 0.1 * (2.0 - std::cos(k * p.x) - std::cos(k * p.y));
    loss.by_x += 0.1 * k * std::sin(k * p.x);
    loss.by_y += 0.1 * k * std::sin(k * p.y);
    return loss;
  };
  DescentOptions options;
  options.rmsprop.momentum = 0.0;
  options.rate = 0.01;
  options.iterations = 400;
  double smoothed = 0.0;
  double plain = 0.0;
  constexpr int kRuns = 20;
  for (int run = 0; run < kRuns; ++run) {
    const Vec3d start{-1.0 + 0.013 * run, 1.0 - 0.017 * run, 1.2};
    std::mt19937_64 random(static_cast<unsigned>(run));
    options.is_smoothed = true;
    smoothed += distance(descend(rippled, start, kBounds, options, random).position, kBowl);
    options.is_smoothed = false;
    plain += distance(descend(rippled, start, kBounds, options, random).position, kBowl);
  }
  EXPECT_LT(smoothed, 0.5 * plain) << smoothed / kRuns << " m, " << plain / kRuns << " m";
}

TEST(PaperDescent, StaysWithinTheBounds) {
  for (const Vec3d& place : asked({}, {-2.9, 1.9, 1.2})) {
    EXPECT_EQ(place, kBounds.nearest(place));
  }
  std::mt19937_64 random(1);
  const auto outwards = [](const Vec3d&) { return LossInPlan{1.0, -1.0, -1.0}; };
  const Descent end = descend(outwards, {9.0, 0.0, 1.2}, kBounds, {}, random);
  EXPECT_EQ(end.position, (Vec3d{3.0, 2.0, 1.2}));
}

TEST(PaperDescent, RateAndMomentumLimitTheDistance) {
  // METHODS C7: 0.03 / (1 - 0.6) a step.
  std::mt19937_64 random(1);
  const PlanBounds wide = {{-50.0, -50.0, 0.0}, {50.0, 50.0, 2.5}};
  const auto slope = [](const Vec3d&) { return LossInPlan{1.0, 1.0, 0.0}; };
  DescentOptions options;
  options.is_smoothed = false;
  const Descent end = descend(slope, {0.0, 0.0, 1.2}, wide, options, random);
  EXPECT_LT(std::abs(end.position.x), 7.5);
  EXPECT_GT(std::abs(end.position.x), 7.2);
}

TEST(PaperDescent, RefusesNumbersThatMakeNoSense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<DescentOptions> bad(8);
  bad[0].iterations = -1;
  bad[1].positions = 0;
  bad[2].variance = 0.0;
  bad[3].least_deviation = nan;
  bad[4].alpha = -0.1;
  bad[5].rate = 0.0;
  bad[6].rmsprop.momentum = 1.0;
  bad[7].rmsprop.decay = nan;
  for (std::size_t i = 0; i < bad.size(); ++i) {
    EXPECT_FALSE(validate(bad[i])) << i;
  }
  EXPECT_TRUE(validate(DescentOptions{}));
}

}  // namespace
}  // namespace rayloc::paper::descent_test
