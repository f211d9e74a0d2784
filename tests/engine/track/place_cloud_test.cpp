#include "engine/track/place_cloud.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace rayloc::place_cloud_test {
namespace {

constexpr HeightPrior kKnownHeight{1.0, 0.0};

double mean_of(std::span<const float> values, std::span<const float> weights) {
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += static_cast<double>(weights[i]) * static_cast<double>(values[i]);
  }
  return sum;
}

double covariance_of(std::span<const float> a,
                     std::span<const float> b,
                     std::span<const float> weights) {
  const double mean_a = mean_of(a, weights);
  const double mean_b = mean_of(b, weights);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += static_cast<double>(weights[i]) * (static_cast<double>(a[i]) - mean_a) *
           (static_cast<double>(b[i]) - mean_b);
  }
  return sum;
}

// Gaussian likelihood of a measured position, relative to its maximum.
std::vector<float> likelihood(const PlaceCloud& cloud, double x, double y, double sigma) {
  std::vector<float> factor;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double dx = static_cast<double>(cloud.x()[i]) - x;
    const double dy = static_cast<double>(cloud.y()[i]) - y;
    factor.push_back(static_cast<float>(std::exp(-0.5 * (dx * dx + dy * dy) / (sigma * sigma))));
  }
  return factor;
}

// A cloud about the origin [m, m/s], all of it walking or at rest.
PlaceCloud cloud_about_origin(std::size_t count,
                              double sigma,
                              bool is_resting,
                              NormalDraws& draws) {
  PlaceCloud cloud;
  cloud.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    CloudPlace place;
    place.x = static_cast<float>(sigma) * draws.normal();
    place.y = static_cast<float>(sigma) * draws.normal();
    place.z = 1.0F;
    place.variance = is_resting ? 0.0F : 0.36F;
    place.is_resting = is_resting;
    cloud.add(place, 0.0F);
  }
  return cloud;
}

// Position and velocity along one axis.
struct Moments {
  double x = 0.0;
  double v = 0.0;
  double xx = 0.0;
  double xv = 0.0;
  double vv = 0.0;

  std::array<double, 5> all() const { return {x, v, xx, xv, vv}; }
};

void predict(Moments& m, double t, double q, double decay) {
  m.x += m.v * t;
  m.v *= decay;
  const double xx = m.xx + 2.0 * t * m.xv + t * t * m.vv + q * t * t * t / 3.0;
  const double xv = decay * (m.xv + t * m.vv + q * t * t / 2.0);
  m.vv = decay * decay * (m.vv + q * t);
  m.xx = xx;
  m.xv = xv;
}

void update(Moments& m, double measured, double variance) {
  const double gain_x = m.xx / (m.xx + variance);
  const double gain_v = m.xv / (m.xx + variance);
  const double error = measured - m.x;
  m.x += gain_x * error;
  m.v += gain_v * error;
  m.vv -= gain_v * m.xv;
  m.xv -= gain_x * m.xv;
  m.xx -= gain_x * m.xx;
}

Moments moments_of(const PlaceCloud& cloud, bool is_y) {
  const std::vector<float> weights = cloud.weights();
  const auto x = is_y ? cloud.y() : cloud.x();
  const auto v = is_y ? cloud.v() : cloud.u();
  std::vector<float> variance;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    variance.push_back(cloud.place(i).variance);
  }
  return {mean_of(x, weights),
          mean_of(v, weights),
          covariance_of(x, x, weights),
          covariance_of(x, v, weights),
          covariance_of(v, v, weights) + mean_of(variance, weights)};
}

TEST(PlaceCloud, IsTheKalmanFilterOnALinearGaussianLikelihood) {
  constexpr std::size_t kPlaces = 20000;
  constexpr std::size_t kRuns = 12;
  constexpr double kStep = 0.1;   // [s]
  constexpr double kSigma = 0.1;  // [m], of a measurement
  constexpr double kFirst = 0.2;  // [m], of the cloud at first
  CloudMotion motion;
  motion.turn_share = 0.0;
  motion.switching_rate = 0.0;
  motion.resampled = {};
  const auto measured_x = [](int step) { return 0.05 * step + 0.04 * std::sin(3.0 * step); };
  const auto measured_y = [](int step) { return 0.05 - 0.002 * step * step; };

  const double decay = std::exp(-kStep / motion.velocity_time);
  std::array<Moments, 2> exact;
  exact.fill({0.0, 0.0, kFirst * kFirst, 0.0, 0.36});
  std::vector<PlaceCloud> clouds;
  std::vector<NormalDraws> draws;
  for (std::size_t run = 0; run < kRuns; ++run) {
    draws.emplace_back(1000 + run);
    clouds.push_back(cloud_about_origin(kPlaces, kFirst, false, draws.back()));
  }
  for (int step = 1; step <= 10; ++step) {
    predict(exact[0], kStep, motion.acceleration, decay);
    predict(exact[1], kStep, motion.acceleration, decay);
    update(exact[0], measured_x(step), kSigma * kSigma);
    update(exact[1], measured_y(step), kSigma * kSigma);
    for (std::size_t run = 0; run < kRuns; ++run) {
      PlaceCloud& cloud = clouds[run];
      cloud.predict(kStep, motion, kKnownHeight, draws[run]);
      cloud.weigh(likelihood(cloud, measured_x(step), measured_y(step), kSigma));
      if (step < 10 && cloud.effective() < 0.5 * kPlaces) {
        ASSERT_TRUE(cloud.resample(kPlaces, motion, true, draws[run]));
      }
    }
  }
  for (const bool is_y : {false, true}) {
    const auto expected = exact[is_y ? 1 : 0].all();
    for (std::size_t k = 0; k < expected.size(); ++k) {
      double mean = 0.0;
      double square = 0.0;
      for (const PlaceCloud& cloud : clouds) {
        const double error = moments_of(cloud, is_y).all()[k] - expected[k];
        mean += error / kRuns;
        square += error * error / kRuns;
      }
      const double deviation = std::sqrt(square - mean * mean);
      EXPECT_LT(std::abs(mean), 3.0 * deviation / std::sqrt(kRuns - 1.0)) << is_y << " " << k;
    }
  }
}

// A walk of 1 m/s that turns by 90 degrees after 3 s, seen every 0.1 s with an error of 5 cm, of
// which a quarter is new: TrackOptions::evidence_time.
TEST(PlaceCloud, FollowsATurnOfNinetyDegrees) {
  constexpr std::size_t kPlaces = 1500;
  constexpr double kStep = 0.1;  // [s]
  const CloudMotion motion;
  for (std::uint64_t key = 1; key <= 5; ++key) {
    NormalDraws draws(key);
    PlaceCloud cloud = cloud_about_origin(kPlaces, 0.1, false, draws);
    for (int step = 1; step <= 60; ++step) {
      const double time = kStep * step;
      const double x = std::min(time, 3.0);
      const double y = std::max(0.0, time - 3.0);
      cloud.predict(kStep, motion, kKnownHeight, draws);
      std::vector<float> factor = likelihood(cloud, x, y, 2.0 * 0.05);
      const float scale = 36.0F / (2.0F * 3.14159F * 0.01F);  // mean 1 over a room of 36 m^2
      for (float& one : factor) {
        one = 0.95F * scale * one + 0.05F;
      }
      cloud.weigh(factor);
      const std::vector<float> weights = cloud.weights();
      const double error =
          std::hypot(mean_of(cloud.x(), weights) - x, mean_of(cloud.y(), weights) - y);
      const bool is_turning = time > 3.0 && time < 4.0;
      EXPECT_LT(error, is_turning ? 0.15 : 0.1) << "at " << time << " s, key " << key;
      if (time > 5.0) {
        EXPECT_NEAR(mean_of(cloud.v(), weights), 1.0, 0.4) << key;
        EXPECT_NEAR(mean_of(cloud.u(), weights), 0.0, 0.4) << key;
      }
      if (cloud.effective() < 0.5 * kPlaces) {
        ASSERT_TRUE(cloud.resample(kPlaces, motion, true, draws));
      }
    }
  }
}

TEST(PlaceCloud, RestsWhereTheChannelRests) {
  NormalDraws draws(4);
  const CloudMotion motion;
  PlaceCloud cloud = cloud_about_origin(1500, 0.1, false, draws);
  EXPECT_EQ(cloud.resting(), 0.0);
  for (int step = 0; step < 20; ++step) {
    cloud.predict(0.1, motion, kKnownHeight, draws);
    cloud.weigh_change(0.0, 10.0);
  }
  EXPECT_GT(cloud.resting(), 0.95);
  for (int step = 0; step < 20; ++step) {
    cloud.predict(0.1, motion, kKnownHeight, draws);
    cloud.weigh_change(1.0, 10.0);
  }
  EXPECT_LT(cloud.resting(), 0.05);
  // Without evidence both are equally probable.
  for (int step = 0; step < 100; ++step) {
    cloud.predict(0.1, motion, kKnownHeight, draws);
    if (step == 0) {
      ASSERT_TRUE(cloud.resample(1500, motion, true, draws));
    }
  }
  EXPECT_NEAR(cloud.resting(), 0.5, 0.06);
}

TEST(PlaceCloud, StaysWhereItRests) {
  NormalDraws draws(5);
  CloudMotion motion;
  motion.switching_rate = 0.0;
  PlaceCloud cloud = cloud_about_origin(1500, 0.001, true, draws);
  for (int step = 0; step < 300; ++step) {
    cloud.predict(0.03, motion, {1.0, 0.3}, draws);
  }
  const std::vector<float> weights = cloud.weights();
  EXPECT_NEAR(std::sqrt(covariance_of(cloud.x(), cloud.x(), weights)), 0.0061, 0.0006);
  EXPECT_NEAR(mean_of(cloud.z(), weights), 1.0, 1e-6);
}

TEST(PlaceCloud, ResamplingKeepsMoments) {
  constexpr std::size_t kPlaces = 4000;
  NormalDraws draws(6);
  const CloudMotion motion;
  PlaceCloud cloud = cloud_about_origin(kPlaces, 0.3, false, draws);
  cloud.predict(0.5, motion, {1.0, 0.3}, draws);
  cloud.weigh(likelihood(cloud, 0.2, -0.1, 0.2));
  const Moments before = moments_of(cloud, false);
  const double resting = cloud.resting();
  const double effective = cloud.effective();
  ASSERT_LT(effective, 0.6 * kPlaces);
  ASSERT_TRUE(cloud.resample(kPlaces / 2, motion, false, draws));
  ASSERT_EQ(cloud.size(), kPlaces / 2);
  EXPECT_NEAR(cloud.effective(), kPlaces / 2.0, 1.0);
  const Moments after = moments_of(cloud, false);
  const double error = 3.0 / std::sqrt(effective);
  EXPECT_NEAR(after.x, before.x, error * std::sqrt(before.xx));
  EXPECT_NEAR(after.v, before.v, error * std::sqrt(before.vv));
  EXPECT_NEAR(after.xx, before.xx, 1.5 * error * before.xx);
  EXPECT_NEAR(after.vv, before.vv, 1.5 * error * before.vv);
  EXPECT_NEAR(cloud.resting(), resting, 0.02);
}

TEST(PlaceCloud, HeightReturnsToItsPrior) {
  NormalDraws draws(7);
  const CloudMotion motion;
  PlaceCloud cloud = cloud_about_origin(4000, 0.1, false, draws);
  const HeightPrior prior{1.3, 0.25};
  for (int step = 0; step < 1200;
       ++step) {  // [0.1 s], six times 1 / rate, and a half of it at rest
    cloud.predict(0.1, motion, prior, draws);
  }
  const std::vector<float> weights = cloud.weights();
  EXPECT_NEAR(mean_of(cloud.z(), weights), prior.mean, 0.03);
  EXPECT_NEAR(std::sqrt(covariance_of(cloud.z(), cloud.z(), weights)), prior.sigma, 0.04);
}

TEST(PlaceCloud, IsTheSameForTheSameKey) {
  const auto run = [](std::uint64_t key) {
    const CloudMotion motion;
    NormalDraws draws(key);
    PlaceCloud cloud = cloud_about_origin(300, 0.2, false, draws);
    for (int step = 0; step < 10; ++step) {
      cloud.predict(0.1, motion, {1.0, 0.2}, draws);
      cloud.weigh(likelihood(cloud, 0.05 * step, 0.0, 0.1));
      cloud.resample(200, motion, false, draws);
    }
    return std::vector<float>(cloud.x().begin(), cloud.x().end());
  };
  EXPECT_EQ(run(9), run(9));
  EXPECT_NE(run(9), run(10));
}

TEST(PlaceCloud, StatesTheMeanFactor) {
  PlaceCloud cloud;
  cloud.add({}, std::log(3.0F));
  cloud.add({}, 0.0F);
  EXPECT_NEAR(cloud.weigh(std::vector<float>{2.0F, 6.0F}), std::log(3.0), 1e-6);
  EXPECT_NEAR(static_cast<double>(cloud.weights()[0]), 0.5, 1e-6);
  EXPECT_NEAR(cloud.effective(), 2.0, 1e-6);
}

TEST(PlaceCloud, ChangesNothingWhereAllWeightsVanish) {
  NormalDraws draws(8);
  PlaceCloud cloud = cloud_about_origin(3, 0.1, false, draws);
  cloud.remove(1);
  EXPECT_NEAR(static_cast<double>(cloud.weights()[0]), 0.5, 1e-6);
  EXPECT_EQ(cloud.weights()[1], 0.0F);
  EXPECT_EQ(cloud.weigh(std::vector<float>{0.0F, 1.0F, 0.0F}),
            -std::numeric_limits<double>::infinity());
  EXPECT_NEAR(cloud.effective(), 2.0, 1e-6);
  EXPECT_NEAR(cloud.weigh(std::vector<float>{0.0F, 1.0F, 1.0F}), std::log(0.5), 1e-6);
  const float x = cloud.place(2).x;
  ASSERT_TRUE(cloud.resample(10, CloudMotion{}, true, draws));
  for (std::size_t i = 0; i < cloud.size(); ++i) {  // only the third place is left
    EXPECT_NEAR(cloud.place(i).x, x, 0.02F);
    cloud.remove(i);
  }
  EXPECT_FALSE(cloud.resample(10, CloudMotion{}, true, draws));
  EXPECT_EQ(cloud.size(), 10U);
  EXPECT_EQ(cloud.effective(), 0.0);
}

}  // namespace
}  // namespace rayloc::place_cloud_test
