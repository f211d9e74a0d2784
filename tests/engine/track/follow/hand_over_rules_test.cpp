#include "engine/track/follow/hand_over_rules.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "engine/base/normal_draws.h"
#include "engine/track/searched_cells.h"

namespace rayloc::hand_over_rules_test {
namespace {

// A room of 4 x 4 m without anything in it.
std::shared_ptr<const FreeSpace> open_room(double step) {
  const Grid grid({-2, -2, 0}, {2, 2, 2.5}, 1.0, step);
  const std::vector<std::uint8_t> all(grid.size(), 1);
  return std::make_shared<const FreeSpace>(FreeSpace{grid, all, all, all});
}

// Equal mass in `count` cells.
GridFilter filter_of(const std::shared_ptr<const FreeSpace>& space, std::size_t count) {
  GridFilter filter(space, {});
  std::vector<std::vector<float>> mass(filter.modes().size(),
                                       std::vector<float>(space->grid.size()));
  for (std::size_t i = 0; i < count; ++i) {
    mass[0][i] = 1.0F;
  }
  filter.set(mass);
  return filter;
}

PlaceCloud cloud_at(double x, double y, double deviation, std::size_t count) {
  PlaceCloud cloud;
  NormalDraws draws(5);
  for (std::size_t i = 0; i < count; ++i) {
    CloudPlace place;
    place.x = static_cast<float>(x) + static_cast<float>(deviation) * draws.normal();
    place.y = static_cast<float>(y) + static_cast<float>(deviation) * draws.normal();
    cloud.add(place, 0.0F);
  }
  return cloud;
}

TEST(HandOverRules, WaitForTheTimeAndTheWidthOfTheGrid) {
  const HandOverOptions options;
  for (const double step : {0.05, 0.1}) {
    const auto space = open_room(step);
    const auto cells = static_cast<std::size_t>(1.0 / (step * step));  // of a square metre
    const auto narrow = filter_of(space, cells - 10);
    const auto wide = filter_of(space, cells + 10);
    EXPECT_FALSE(hands_over(narrow, space->grid, from_seconds(1.9), options));
    EXPECT_TRUE(hands_over(narrow, space->grid, from_seconds(2.0), options));
    EXPECT_FALSE(hands_over(wide, space->grid, from_seconds(2.0), options));
    HandOverOptions any = options;
    any.max_cells = 0.0;
    EXPECT_TRUE(hands_over(wide, space->grid, from_seconds(2.0), any));
  }
}

TEST(HandOverRules, WidthOfACloudIsThatOfItsDistribution) {
  const auto space = open_room(0.05);
  EXPECT_EQ(effective_cells(PlaceCloud{}, space->grid), 0.0);
  // Entropy of a normal distribution in the plane: 2 pi e s^2, in cells of 25 square centimetres.
  const double expected = 2.0 * std::numbers::pi * std::numbers::e * 0.3 * 0.3 / 0.0025;
  for (const std::size_t places : {std::size_t{1500}, std::size_t{6000}}) {
    const double found = effective_cells(cloud_at(0.1, 0.1, 0.3, places), space->grid);
    EXPECT_NEAR(found / expected, 1.0, 0.2) << places;
  }
  // The narrow one is in one square of 10 cm.
  EXPECT_NEAR(effective_cells(cloud_at(0.06, 0.06, 1e-3, 600), space->grid), 4.0, 1e-6);
}

TEST(HandOverRules, TakeBackWhatIsBroadOrNotThere) {
  const HandOverOptions options;
  EXPECT_FALSE(is_taken_back({799.0, 0.49, 0.66}, options));
  EXPECT_TRUE(is_taken_back({801.0, 0.0, 0.0}, options));
  EXPECT_TRUE(is_taken_back({10.0, 0.51, 0.0}, options));
  EXPECT_TRUE(is_taken_back({10.0, 0.0, 0.67}, options));
  HandOverOptions any = options;
  any.return_cells = 0.0;
  EXPECT_FALSE(is_taken_back({5000.0, 0.0, 0.0}, any));
  // A target that was just handed over is not taken back for its width.
  EXPECT_GE(options.return_cells, 1.5 * options.max_cells);
}

TEST(HandOverRules, ARivalGetsEvenOdds) {
  const HandOverOptions options;
  EXPECT_EQ(spread_of(0.0, false, options), options.least_spread);
  EXPECT_EQ(spread_of(0.3, false, options), 0.3);
  EXPECT_EQ(spread_of(0.3, true, options), options.rival_spread);
  EXPECT_EQ(spread_of(0.9, true, options), 0.9);
}

TEST(HandOverRules, RivalIsTheBestCellAtADistance) {
  auto space = *open_room(0.05);
  const Grid& grid = space.grid;
  PlaceCloud cloud = cloud_at(0.5, 0.5, 0.02, 300);
  CloudPlace stray;
  stray.x = -1.0F;
  stray.y = 0.5F;
  cloud.add(stray, 0.0F);
  std::vector<double> map(grid.size(), -5.0);
  map[grid.cell_at(0.8, 0.4)] = 7.0;   // near
  map[grid.cell_at(-1.0, 0.5)] = 6.0;  // at a distance
  map[grid.cell_at(-1.0, -1.0)] = 9.0;
  space.free[grid.cell_at(-1.0, -1.0)] = 0;
  const RoomBest best = best_beside(cloud, space, map, 0.5);
  EXPECT_EQ(best.near, 7.0);
  EXPECT_EQ(best.rival, 6.0);
  const RoomBest everywhere = best_beside(cloud, space, map, 10.0);
  EXPECT_EQ(everywhere.near, 7.0);
  EXPECT_FALSE(std::isfinite(everywhere.rival));
  EXPECT_EQ(rival_lead(2.5, everywhere, 0.1, 1.0, {}), 0.0);
}

TEST(HandOverRules, ARivalMustLeadInSeveralMoments) {
  const HandOverOptions options;
  const RoomBest far_better{0.0, 1000.0};
  const RoomBest worse{0.0, -1000.0};
  const RoomBest alike{100.0, 105.0};  // 0.5 nat at this exponent
  constexpr double kExponent = 0.1;
  double lead = rival_lead(0.0, far_better, kExponent, 1.0, options);
  EXPECT_GT(lead, 0.0);
  EXPECT_FALSE(is_rival_better(lead, options));
  lead = rival_lead(lead, far_better, kExponent, 1.0, options);
  EXPECT_TRUE(is_rival_better(lead, options));
  EXPECT_FALSE(is_rival_better(rival_lead(lead, worse, kExponent, 1.0, options), options));
  // The gain of many wrong places by chance adds up to nothing.
  lead = 0.0;
  for (int i = 0; i < 100; ++i) {
    lead = rival_lead(lead, alike, kExponent, 1.0, options);
  }
  EXPECT_EQ(lead, 0.0);
  // A moment that is not new counts little.
  EXPECT_LT(rival_lead(0.0, far_better, kExponent, 0.1, options), 0.5);
  // No place near the cloud explains the moment.
  const RoomBest none_near{-std::numeric_limits<double>::infinity(), 3.0};
  EXPECT_EQ(rival_lead(0.0, none_near, kExponent, 1.0, options),
            rival_lead(0.0, far_better, kExponent, 1.0, options));
}

TEST(HandOverRules, TheNextEvaluationIsSoonWhileARivalLeads) {
  EXPECT_EQ(next_search_period(kFirstWholeRoomPeriod, 0.0), 2 * kFirstWholeRoomPeriod);
  EXPECT_EQ(next_search_period(kWholeRoomPeriod, 0.0), kWholeRoomPeriod);
  EXPECT_EQ(next_search_period(kWholeRoomPeriod, 0.5), kFirstWholeRoomPeriod);
}

}  // namespace
}  // namespace rayloc::hand_over_rules_test
