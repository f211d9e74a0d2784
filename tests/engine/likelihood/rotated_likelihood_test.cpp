#include "engine/likelihood/rotated_likelihood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "engine/likelihood/observation_model.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::rotated_likelihood_test {
namespace {

using Value = std::complex<double>;

// The channel of a device at an access point of the synthetic room, and some places to compare.
struct Scene {
  RoomModel room = test::make_room();
  ObservationModel model{room.grid, 3};
  std::vector<Value> h = test::channel_at(room, room.access_points[0], {0.4, -0.5, 1.2});
  std::vector<PlaceModel> places;

  Scene() {
    const RoomAccessPoint& ap = room.access_points[0];
    const auto offsets = offsets_of(ap.array);
    const PathTracer tracer(room.scene, room.trace);
    for (const Vec3d& at : {Vec3d{0.4, -0.5, 1.2}, Vec3d{-0.9, 0.7, 1.2}, Vec3d{1.1, 0.2, 1.2}}) {
      places.push_back(
          model.place({test::rays_to(tracer, room, ap.array, at), offsets, 0.05}, ap.error));
    }
  }

  // The observation of a radio whose chains multiply by these factors.
  ObservedArray observed(const std::vector<Value>& factors) const {
    std::vector<Value> y = h;
    for (std::size_t j = 0; j < y.size(); ++j) {
      y[j] *= factors[j / room.grid.size()];
    }
    return model.observe(y);
  }
};

TEST(RotatedLikelihood, MatchesTheDerotatedBurstInEveryState) {
  const Scene scene;
  const RotationGrid grid(3);
  const ObservedArray as_received = scene.observed({1.0, 1.0, 1.0});
  std::vector<float> coarse(grid.size());
  std::vector<float> fine(grid.size());
  for (const PlaceModel& place : scene.places) {
    const auto windows = coarse_of_turns(place, as_received, 3, grid.undoing(), coarse);
    log_likelihood_of_turns(place, as_received, windows, grid, fine);
    for (std::size_t state = 0; state < grid.size(); state += 13) {
      std::vector<Value> back;
      for (std::size_t m = 0; m < 3; ++m) {
        back.push_back(std::polar(1.0, -grid.phase(state, m)));
      }
      const ObservedArray rotated = scene.observed(back);
      const auto plain = ObservationModel::coarse(place, rotated);
      EXPECT_NEAR(coarse[state], plain.log_likelihood, 0.02) << state;
      // The plain one has a parabola between delays of 1.5 ns.
      const double best = ObservationModel::log_likelihood(place, rotated, 0xFF);
      EXPECT_NEAR(fine[state], best, 2.0) << state;
      EXPECT_LT(fine[state], best + 0.02) << state;
    }
  }
}

TEST(RotatedLikelihood, MatchesTheDividedArrayForAnyFactors) {
  const Scene scene;
  const std::vector<Value> factors = {1.0, std::polar(1.3, 0.7), std::polar(0.8, -2.1)};
  const std::vector<Value> undoing = {1.0, 1.0 / factors[1], 1.0 / factors[2]};
  const ObservedArray received = scene.observed(factors);
  const ObservedArray divided = scene.observed({1.0, 1.0, 1.0});
  std::vector<double> of_moments;
  std::vector<double> plain;
  for (const PlaceModel& place : scene.places) {
    of_moments.push_back(chain_moments(place, received, undoing).log_likelihood(undoing));
    plain.push_back(ObservationModel::log_likelihood(place, divided));
  }
  // They differ by what the unit power of the burst and the factors' volume make of all places.
  for (std::size_t i = 1; i < plain.size(); ++i) {
    EXPECT_NEAR(of_moments[i] - of_moments[0], plain[i] - plain[0], 1.0) << i;
  }
  EXPECT_GT(of_moments[0], of_moments[1] + 10.0);
}

// The likelihood of a corrected burst is that of the burst with the correction as a factor.
TEST(RotatedLikelihood, MatchesTheProductOfSuccessiveFactors) {
  const Scene scene;
  const ObservedArray received = scene.observed({1.0, std::polar(1.2, 0.4), std::polar(0.9, -1.0)});
  const std::vector<Value> factor = {1.0, std::polar(0.8, -0.5), std::polar(1.1, 0.9)};
  const std::vector<Value> more = {1.0, std::polar(1.1, 0.1), std::polar(1.0, 0.2)};
  std::vector<Value> both;
  for (std::size_t m = 0; m < 3; ++m) {
    both.push_back(factor[m] * more[m]);
  }
  std::vector<double> difference;
  for (const PlaceModel& place : scene.places) {
    const ChainMoments moments = chain_moments(place, received, factor);
    difference.push_back(moments.multiplied(factor).log_likelihood(more) -
                         moments.log_likelihood(both));
  }
  // By the volume of the factors, which is that of no place.
  EXPECT_NEAR(difference[1], difference[0], 1e-6);
  EXPECT_NEAR(difference[2], difference[0], 1e-6);
}

// A common gain is no evidence.
TEST(RotatedLikelihood, CommonFactorOfAllChainsChangesNothing) {
  const Scene scene;
  const ObservedArray received = scene.observed({1.0, 1.0, 1.0});
  const ChainMoments moments =
      chain_moments(scene.places[0], received, std::vector<Value>{1.0, 1.0, 1.0});
  const Value common = std::polar(1.7, 0.4);
  EXPECT_NEAR(moments.log_likelihood(std::vector<Value>{1.0, 1.0, 1.0}),
              moments.log_likelihood(std::vector<Value>{common, common, common}),
              1e-6);
}

TEST(RotationGrid, StatesRotateAllChainsButTheFirst) {
  const RotationGrid grid(3);
  EXPECT_EQ(grid.size(), 16U * 16U);
  EXPECT_EQ(grid.turn(17, 0), 0U);
  EXPECT_EQ(grid.turn(17, 1), 1U);
  EXPECT_EQ(grid.turn(17, 2), 1U);
  EXPECT_NEAR(grid.phase(15, 2), -grid.step(), 1e-12);
  EXPECT_EQ(grid.distance(0, 15), 1U);
  EXPECT_EQ(grid.distance(2, 16 * 8 + 1), 8U);
  EXPECT_EQ(RotationGrid(1).size(), 1U);
  EXPECT_EQ(RotationGrid(4).size(), 8U * 8U * 8U);
}

}  // namespace
}  // namespace rayloc::rotated_likelihood_test
