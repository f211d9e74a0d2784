#include "engine/track/cloud_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <vector>

#include "tests/support/synthetic_room.h"

namespace rayloc::cloud_filter_test {
namespace {

using std::chrono::milliseconds;

constexpr std::uint64_t kSeed = 77;

std::shared_ptr<const Localizer> localizer() {
  static const auto kMade = std::make_shared<const Localizer>(
      *Localizer::create(std::make_shared<const RoomModel>(test::make_room()), {}));
  return kMade;
}

// All cells are free; x = `wall` cannot be passed.
std::shared_ptr<const CloudRoom> room(double wall = 100.0) {
  const Grid& grid = localizer()->grid();
  const std::vector<std::uint8_t> all(grid.size(), 1);
  FreeSpace space{grid, all, all, all};
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    const bool has_wall = grid.centre(cell).x < wall && grid.centre(cell).x + grid.step_x >= wall;
    space.link_y[cell] = (cell + 1) % grid.count_y != 0 ? 1 : 0;
    space.link_x[cell] = cell + grid.count_y < grid.size() && !has_wall ? 1 : 0;
  }
  return make_cloud_room(localizer(), std::make_shared<const FreeSpace>(std::move(space)));
}

// Likelihoods of a hill, times the exponent a normal distribution of 5 cm.
struct Hill {
  Vec3d middle;
  double height = 20.0;  // above a place that explains nothing [nat]
};
CloudEvidence::Compare hill(std::shared_ptr<Hill> where) {
  return
      [where = std::move(where)](
          const RoomObservation& observation, const SearchedPlaces& places, PlaceSearch::Spread) {
        const double exponent = localizer()->room().likelihood_exponent;
        const std::size_t padded = (places.x.size() + 7) / 8 * 8;
        std::vector<float> values(padded);
        for (std::size_t i = 0; i < padded; ++i) {
          const std::size_t place = std::min(i, places.x.size() - 1);
          const double x = static_cast<double>(places.x[place]) - where->middle.x;
          const double y = static_cast<double>(places.y[place]) - where->middle.y;
          const double of_hill = where->height - 0.5 * (x * x + y * y) / (0.05 * 0.05);
          values[i] = static_cast<float>(std::max(of_hill, -20.0) / exponent);
        }
        return std::vector<std::vector<float>>(observation.arrays.size(), values);
      };
}

RoomObservation moment(int ms, std::size_t access_points) {
  RoomObservation observation;
  for (std::size_t ap = 0; ap < access_points; ++ap) {
    observation.arrays.emplace_back().ap = ap;
  }
  observation.estimate.time = Timestamp(milliseconds(ms));
  return observation;
}

PlaceCloud cloud_at(const Vec3d& middle, std::size_t count) {
  PlaceCloud cloud;
  NormalDraws draws(3);
  for (std::size_t i = 0; i < count; ++i) {
    CloudPlace place;
    place.x = static_cast<float>(middle.x) + 0.05F * draws.normal();
    place.y = static_cast<float>(middle.y) + 0.05F * draws.normal();
    place.z = static_cast<float>(localizer()->grid().first.z);
    place.variance = 0.09F;
    cloud.add(place, 0.0F);
  }
  return cloud;
}

Vec3d walker(int ms) { return {-0.8 + 0.5e-3 * ms, 0.4 - 0.3e-3 * ms, 1.2}; }

struct FilterRun {
  std::vector<float> x;
  double error = 0.0;  // [m], of the last summary
  Vec3d velocity;
};

FilterRun run(std::uint64_t seed) {
  const auto where = std::make_shared<Hill>();
  CloudFilter filter(room(), {}, seed, cloud_at(walker(0), 2000), Timestamp(), hill(where));
  FilterRun result;
  for (int ms = 100; ms <= 2000; ms += 100) {
    where->middle = walker(ms);
    filter.advance(Timestamp(milliseconds(ms)));
    EXPECT_TRUE(filter.weigh(moment(ms, 1), 0.25));
    filter.weigh_change(1.0, 10.0);
    LocationEstimate location;
    filter.summarise({}, location);
    EXPECT_TRUE(location.position) << ms;
    if (location.position) {
      result.error =
          std::hypot(location.position->x - walker(ms).x, location.position->y - walker(ms).y);
      result.velocity = filter.velocity(*location.position);
    }
    filter.thin();
  }
  result.x.assign(filter.cloud().x().begin(), filter.cloud().x().end());
  return result;
}

TEST(CloudFilter, FollowsAWalk) {
  const FilterRun found = run(kSeed);
  EXPECT_LT(found.error, 0.1);
  EXPECT_NEAR(found.velocity.x, 0.5, 0.2);
  EXPECT_NEAR(found.velocity.y, -0.3, 0.2);
}

TEST(CloudFilter, IsTheSameForTheSameTarget) {
  EXPECT_EQ(run(kSeed).x, run(kSeed).x);
  EXPECT_NE(run(kSeed).x, run(kSeed + 1).x);
}

TEST(CloudFilter, HasFewerPlacesInEachMoment) {
  for (const std::size_t access_points : {std::size_t{1}, std::size_t{3}}) {
    const auto where = std::make_shared<Hill>(Hill{{0.2, 0.1, 1.2}, 20.0});
    const CloudOptions options;
    CloudFilter filter(room(),
                       options,
                       kSeed,
                       cloud_at(where->middle, options.places_at_first),
                       Timestamp(),
                       hill(where));
    std::size_t before = filter.cloud().size();
    for (int ms = 100; ms <= 1000; ms += 100) {
      filter.advance(Timestamp(milliseconds(ms)));
      ASSERT_TRUE(filter.weigh(moment(ms, access_points), 0.25));
      filter.thin();
      EXPECT_GE(3 * filter.cloud().size() + 3, 2 * before);
      EXPECT_LE(filter.cloud().size(), before);
      before = filter.cloud().size();
    }
    EXPECT_EQ(before, access_points == 1 ? options.places_of_one : options.places_of_more);
  }
}

TEST(CloudFilter, NoPlaceCrossesAWall) {
  const Vec3d beside{-0.15, 0.0, 1.2};
  const auto where = std::make_shared<Hill>(Hill{{0.1, 0.0, 1.2}, 20.0});
  const auto behind_wall = room(0.0);
  const Grid& grid = behind_wall->space->grid;
  std::size_t first = 0;  // column of cells behind the wall
  while (grid.centre(first * grid.count_y).x < 0.0) {
    ++first;
  }
  PlaceCloud cloud;
  NormalDraws draws(8);
  for (int i = 0; i < 2000; ++i) {
    CloudPlace place;
    place.x = static_cast<float>(beside.x - 0.1 * draws.uniform());
    place.y = 0.05F * draws.normal();
    place.z = static_cast<float>(grid.first.z);
    place.u = 0.5F;
    place.variance = 0.09F;
    cloud.add(place, 0.0F);
  }
  CloudFilter filter(behind_wall, {}, kSeed, std::move(cloud), Timestamp(), hill(where));
  for (int ms = 100; ms <= 600; ms += 100) {
    filter.advance(Timestamp(milliseconds(ms)));
    double behind = 0.0;
    const std::vector<float> weights = filter.cloud().weights();
    for (std::size_t i = 0; i < filter.cloud().size(); ++i) {
      const std::size_t cell = cell_of(filter.cloud(), i, grid);
      behind += cell / grid.count_y >= first ? static_cast<double>(weights[i]) : 0.0;
    }
    EXPECT_EQ(behind, 0.0) << ms;
  }
  EXPECT_GT(filter.cloud().effective(), 10.0);
}

// The hill is where the cloud is not: each moment is explained better anywhere else.
TEST(CloudFilter, NoticesATargetThatIsAtNoneOfThePlaces) {
  const auto where = std::make_shared<Hill>(Hill{{-0.8, 0.4, 1.2}, 20.0});
  const auto everywhere_but = [](const RoomObservation& observation,
                                 const SearchedPlaces& places,
                                 PlaceSearch::Spread spread) {
    const double exponent = localizer()->room().likelihood_exponent;
    const double of_all = spread == PlaceSearch::Spread::kApart ? 10.0 : 1.0;
    const std::size_t padded = (places.x.size() + 7) / 8 * 8;
    return std::vector<std::vector<float>>(
        observation.arrays.size(),
        std::vector<float>(padded, static_cast<float>(of_all / exponent)));
  };
  CloudFilter filter(room(), {}, kSeed, cloud_at(where->middle, 1500), Timestamp(), everywhere_but);
  EXPECT_LT(filter.away(), 1e-3);
  for (int ms = 100; ms <= 3000; ms += 100) {
    filter.advance(Timestamp(milliseconds(ms)));
    ASSERT_TRUE(filter.weigh(moment(ms, 1), 1.0));
    filter.thin();
  }
  EXPECT_GT(filter.away(), 0.99);
  LocationEstimate location;
  filter.summarise({}, location);
  EXPECT_GT(location.residual_probability, 0.9);
}

TEST(CloudFilter, AnUnexplainedMomentChangesNothing) {
  const auto where = std::make_shared<Hill>(Hill{{0.2, 0.1, 1.2}, -30.0});
  CloudFilter filter(room(), {}, kSeed, cloud_at(where->middle, 500), Timestamp(), hill(where));
  filter.advance(Timestamp(milliseconds(100)));
  const std::vector<float> before = filter.cloud().weights();
  const double away = filter.away();
  EXPECT_FALSE(filter.weigh(moment(100, 1), 0.25));
  EXPECT_EQ(filter.cloud().weights(), before);
  EXPECT_EQ(filter.away(), away);
}

TEST(CloudFilter, FramesOfOneAccessPointAreDueAfterAWhile) {
  const auto where = std::make_shared<Hill>();
  CloudFilter filter(room(), {}, kSeed, cloud_at({}, 100), Timestamp(), hill(where));
  const auto frames = [](int ms, std::initializer_list<std::size_t> access_points) {
    std::vector<CsiFrame> made;
    for (const std::size_t access_point : access_points) {
      made.emplace_back().time = Timestamp(milliseconds(ms));
      made.back().access_point = access_point;
    }
    return made;
  };
  EXPECT_TRUE(filter.is_due(frames(0, {0})));
  filter.note(frames(0, {0}));
  EXPECT_FALSE(filter.is_due(frames(50, {0})));
  EXPECT_TRUE(filter.is_due(frames(50, {1}))) << "the other one is not left out";
  EXPECT_TRUE(filter.is_due(frames(50, {0, 1})));
  EXPECT_TRUE(filter.is_due(frames(100, {0})));
  filter.note(frames(100, {0, 1, 2}));
  EXPECT_FALSE(filter.is_due(frames(150, {2})));
  EXPECT_FALSE(filter.is_due(frames(150, {2, 2})));
}

}  // namespace
}  // namespace rayloc::cloud_filter_test
