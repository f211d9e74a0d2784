#include "engine/likelihood/burst_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include "engine/likelihood/observation_model.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::burst_noise_test {
namespace {

using Value = std::complex<double>;

const Vec3d kTruth{0.4, -0.5, 1.2};

// One access point of the synthetic room, modelled well, and a device with a weak signal.
class BurstNoise : public ::testing::Test {
 protected:
  BurstNoise()
      : room_(test::make_room()),
        tracer_(room_.scene, room_.trace),
        model_(room_.grid, 3),
        offsets_(offsets_of(array())) {
    error_.plan_tolerance = 0.002;
    error_.diffuse = 0.01;
    error_.noise = 1e-4;
  }

  const AntennaArray& array() const { return room_.access_points[0].array; }

  std::vector<Ray> rays(const Vec3d& position) const {
    return test::rays_to(tracer_, room_, array(), position);
  }

  // A burst from kTruth with noise of this share of the power within the basis, as in observe() and
  // BurstObservation.
  ObservedArray received_with(double noise) const {
    auto h = model_.expected({rays(kTruth), offsets_, 0.0}, error_);
    double power = 0.0;
    for (const Value& v : h) {
      power += std::norm(v);
    }
    const double variance = noise * power / static_cast<double>(model_.dimension());
    std::mt19937 random(3);
    std::normal_distribution<double> normal(0.0, std::sqrt(0.5 * variance));
    for (Value& v : h) {
      const double real = normal(random);
      v += Value(real, normal(random));
    }
    ObservedArray observed = model_.observe(h);
    observed.noise = noise;
    return observed;
  }

  RoomModel room_;
  PathTracer tracer_;
  ObservationModel model_;
  ModelError error_;
  std::vector<Vec3d> offsets_;
};

// Places as near as the map's are to each other, and far away.
std::vector<Vec3d> places() {
  std::vector<Vec3d> all;
  for (const Vec3d off : {Vec3d{},
                          {0.003, 0.0, 0.0},
                          {0.02, 0.01, 0.0},
                          {0.1, -0.1, 0.0},
                          {-0.7, 0.9, 0.0},
                          {0.6, 0.4, 0.0},
                          {-1.2, 0.1, 0.0}}) {
    all.push_back(kTruth + off);
  }
  return all;
}

TEST_F(BurstNoise, IsNearlyThatOfAModelWithTheNoise) {
  for (const double noise : {3e-5, 1e-4, 4e-4}) {
    const ObservedArray observed = received_with(noise);
    ObservedArray as_if_clean = observed;
    as_if_clean.noise = 0.0;
    double most = 0.0;
    double most_neglected = 0.0;
    for (const Vec3d& position : places()) {
      const auto traced = rays(position);
      const ObservationModel::Place place{traced, offsets_, 0.007};
      const PlaceModel without = model_.place(place, error_);
      const double exact = ObservationModel::log_likelihood(
          model_.place_of_burst(place, error_, observed), observed);
      const auto off = [&](const ObservedArray& as) {
        return std::abs(ObservationModel::log_likelihood(without, as) - exact);
      };
      most = std::max(most, off(observed));
      most_neglected = std::max(most_neglected, off(as_if_clean));
    }
    // Log-likelihoods differ by 50 from place to place.
    EXPECT_LT(most, 2.0) << noise;
    EXPECT_LT(most, most_neglected) << noise;
  }
}

// The search for a delay ignores the noise: the likelihood that it misses is the device's place's.
TEST_F(BurstNoise, RanksPlacesAsAModelWithTheNoiseDoes) {
  const ObservedArray observed = received_with(2e-3);
  const auto log_likelihood = [&](const Vec3d& position) {
    const auto traced = rays(position);
    return ObservationModel::log_likelihood(model_.place({traced, offsets_, 0.007}, error_),
                                            observed);
  };
  const auto all = places();
  const double here = log_likelihood(all.front());
  for (const Vec3d& position : all) {
    if (norm(position - kTruth) > 0.5) {
      EXPECT_GT(here, log_likelihood(position) + 5.0);
    }
  }
}

// Exact where there is nothing but noise: a Gaussian of n + n' by hand.
TEST_F(BurstNoise, IsExactOfNoiseAlone) {
  constexpr std::size_t kSize = 6;
  constexpr double kNoise = 0.3;
  PlaceModel place;
  for (std::size_t i = 0; i < kSize; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      place.whitener.emplace_back(i == j ? static_cast<float>(std::sqrt(kSize / kNoise)) : 0.0F);
    }
    place.mean.emplace_back(0.0F);
  }
  place.log_determinant = kSize * std::log(kNoise / kSize);
  place.noise = static_cast<float>(kNoise);
  ObservedArray observed(kSize);
  observed.noise = 0.5;
  for (std::size_t i = 0; i < kSize; ++i) {
    observed.set(i, 0, {0.2 * static_cast<double>(i), 0.1});
  }
  double power = 0.0;  // with the noise
  for (std::size_t i = 0; i < kSize; ++i) {
    power += std::norm(observed.value(i, 0)) * kSize / (kNoise + observed.noise);
  }
  const double gain = std::sqrt(kSize / power);
  const double expected = 2.0 * kSize * std::log(gain) - gain * gain * power -
                          kSize * std::log((kNoise + observed.noise) / kSize);
  EXPECT_NEAR(log_likelihood_with_noise(place, observed, observed.windows[0], 0), expected, 1e-4);
}

TEST_F(BurstNoise, HasNoEffectForAStrongDevice) {
  ObservedArray observed = received_with(1e-6);
  const auto traced = rays(kTruth);
  const PlaceModel place = model_.place({traced, offsets_, 0.007}, error_);
  EXPECT_FALSE(lacks_noise(place, observed));
  const double with = ObservationModel::log_likelihood(place, observed);
  observed.noise = 0.0;
  EXPECT_EQ(with, ObservationModel::log_likelihood(place, observed));
}

}  // namespace
}  // namespace rayloc::burst_noise_test
