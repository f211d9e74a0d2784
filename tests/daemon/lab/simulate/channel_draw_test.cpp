#include "daemon/lab/simulate/channel_draw.h"

#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/constants.h"
#include "engine/localize/localizer.h"
#include "engine/observe/alignment.h"
#include "engine/posterior/credible_region.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::channel_draw_test {
namespace {

using Value = std::complex<double>;

constexpr Vec3d kPlace{0.4, -0.5, 1.2};
constexpr int kDraws = 4000;
constexpr ModelError kExact = {
    .plan_tolerance = 0.0, .diffuse = 0.0, .noise = 0.0, .strength = 0.0};

// The first access point alone, with these errors.
RoomModel room_with(const ModelError& error) {
  RoomModel room = test::make_room();
  room.access_points.resize(1);
  room.access_points[0].error = error;
  return room;
}

// Statistics of many draws: mean and variance of each value, covariances of the first antenna.
struct Moments {
  std::vector<Value> mean;
  std::vector<double> variance;
  std::vector<Value> with_first;    // tone of an antenna with its first
  std::vector<Value> with_antenna;  // tone of the first antenna with the same of the second
};

Moments moments_of(const RoomModel& room) {
  const std::size_t tones = room.grid.size();
  ChannelDraw draws(room, 0, RandomStream(7));
  std::vector<std::vector<Value>> all;
  Moments m;
  m.mean.resize(3 * tones);
  for (int n = 0; n < kDraws; ++n) {
    all.push_back(draws.at({kPlace, {}}, room.grid).h);
    for (std::size_t i = 0; i < 3 * tones; ++i) {
      m.mean[i] += all.back()[i] / static_cast<double>(kDraws);
    }
  }
  m.variance.resize(3 * tones);
  m.with_first.resize(tones);
  m.with_antenna.resize(tones);
  for (std::vector<Value>& h : all) {
    for (std::size_t i = 0; i < 3 * tones; ++i) {
      h[i] -= m.mean[i];
      m.variance[i] += std::norm(h[i]) / kDraws;
    }
    for (std::size_t k = 0; k < tones; ++k) {
      m.with_first[k] += h[k] * std::conj(h[0]) / static_cast<double>(kDraws);
      m.with_antenna[k] += h[k] * std::conj(h[tones + k]) / static_cast<double>(kDraws);
    }
  }
  return m;
}

double traced_power(const std::vector<Ray>& rays) {
  double power = 0.0;
  for (const Ray& ray : rays) {
    power += std::norm(ray.amplitude);
  }
  return power;
}

std::vector<Ray> rays_of_room(const RoomModel& room) {
  return test::rays_to(
      PathTracer(room.scene, room.trace), room, room.access_points[0].array, kPlace);
}

// Without errors a draw is the channel that is traced to each element.
TEST(ChannelDraw, WithoutErrorsIsTheTracersChannel) {
  const RoomModel room = room_with(kExact);
  const auto h = ChannelDraw(room, 0, RandomStream(1)).at({kPlace, {}}, room.grid);
  EXPECT_GT(h.rays, 5U);
  const auto traced = test::channel_at(room, room.access_points[0], kPlace);
  EXPECT_GT(Aligner(room.grid).align(h.h, traced).correlation, 0.999);
  double drawn = 0.0;
  double power = 0.0;
  for (std::size_t i = 0; i < traced.size(); ++i) {
    drawn += std::norm(h.h[i]);
    power += std::norm(traced[i]);
  }
  EXPECT_NEAR(drawn / power, 1.0, 0.02);
}

// An exponential decay with time T has the correlation 1 / (1 + j 2 pi f T) over frequency.
TEST(ChannelDraw, DiffusePowerDecaysAndIsAnotherInEveryAntenna) {
  ModelError error = kExact;
  error.diffuse = 0.2;
  error.diffuse_exponent = 0.5;
  error.diffuse_decay = 15e-9;
  const RoomModel room = room_with(error);
  const auto rays = rays_of_room(room);
  const double expected = traced_power(rays) * diffuse_share(error, rays.front().length);
  const Moments m = moments_of(room);
  const std::size_t tones = room.grid.size();
  for (const std::size_t i : {std::size_t{0}, tones / 2, tones + 3, 3 * tones - 1}) {
    EXPECT_NEAR(m.variance[i] / expected, 1.0, 0.06) << i;
  }
  for (const std::size_t k : {tones / 4, tones / 2, tones - 1}) {
    const double apart = 2.0 * std::numbers::pi * (room.grid.offset_hz(k) - room.grid.offset_hz(0));
    const Value correlation = std::polar(1.0, -apart * rays.front().length / kSpeedOfLight) /
                              Value(1.0, apart * error.diffuse_decay);
    EXPECT_NEAR(std::abs(m.with_first[k] / expected - correlation), 0.0, 0.06) << k;
    EXPECT_LT(std::abs(m.with_antenna[k]) / expected, 0.06) << k;
  }
}

// A surface displaced by s along its normal turns a wave by 2 k s cos of the angle of incidence.
TEST(ChannelDraw, DisplacedSurfacesRotateThePhaseOfReflections) {
  ModelError error = kExact;
  error.plan_tolerance = 0.008;
  const RoomModel room = room_with(error);
  const double wave_number = 2.0 * std::numbers::pi * room.grid.centre_hz / kSpeedOfLight;
  const auto offsets = offsets_of(room.access_points[0].array);
  const auto rays = rays_of_room(room);
  const Moments m = moments_of(room);
  const std::size_t tones = room.grid.size();
  const double deviation = std::sqrt(traced_power(rays) / kDraws);
  for (std::size_t antenna = 0; antenna < 3; ++antenna) {
    for (const std::size_t k : {std::size_t{0}, tones - 1}) {
      Value mean;
      double variance = 0.0;
      for (const Ray& ray : rays) {
        const double sigma =
            2.0 * wave_number * error.plan_tolerance * std::sqrt(ray.cos2_incidence);
        const double known = std::exp(-0.5 * sigma * sigma);
        const double length = norm(ray.length * ray.at_array - offsets[antenna]);
        mean +=
            known * ray.amplitude *
            std::polar(
                1.0, -2.0 * std::numbers::pi * room.grid.frequency_hz(k) * length / kSpeedOfLight);
        variance += (1.0 - known * known) * std::norm(ray.amplitude);
      }
      const std::size_t i = antenna * tones + k;
      EXPECT_LT(std::abs(m.mean[i] - mean), 4.0 * deviation) << i;
      EXPECT_NEAR(m.variance[i] / variance, 1.0, 0.08) << i;
    }
  }
}

TEST(ChannelDraw, StrengthsAndTheRestHaveTheirPower) {
  ModelError error = kExact;
  error.strength = 1.0;
  const RoomModel strengths = room_with(error);
  double variance = 0.0;
  const auto rays = rays_of_room(strengths);
  for (const Ray& ray : rays) {
    const std::vector<double> shares = {0.02, 0.1, 0.2, 0.3};  // METHODS B2, u_p
    variance += shares.at(static_cast<std::size_t>(ray.reflections)) * std::norm(ray.amplitude);
  }
  EXPECT_NEAR(moments_of(strengths).variance[5] / variance, 1.0, 0.08);

  error = kExact;
  error.noise = 0.01;
  const RoomModel noisy = room_with(error);
  const ObservationModel model(noisy.grid, 3);
  const Moments m = moments_of(noisy);
  const double per_tone = traced_power(rays) * error.noise *
                          static_cast<double>(3 * noisy.grid.size()) /
                          static_cast<double>(model.dimension());
  EXPECT_NEAR(m.variance[3] / per_tone, 1.0, 0.08);
  EXPECT_LT(std::abs(m.with_first[4]) / per_tone, 0.08);
}

TEST(ChannelDraw, ASeedGivesTheSameAndAPlaceBehindAWallNothing) {
  const RoomModel room = room_with({});
  const auto at = [&](unsigned seed, const Vec3d& place) {
    return ChannelDraw(room, 0, RandomStream(seed)).at({place, {}}, room.grid);
  };
  EXPECT_EQ(at(3, kPlace).h, at(3, kPlace).h);
  EXPECT_NE(at(3, kPlace).h, at(4, kPlace).h);
  const auto outside = at(3, {9.0, 0.0, 1.2});
  EXPECT_EQ(outside.rays, 0U);
  EXPECT_EQ(outside.h, std::vector<Value>(outside.h.size()));
}

// Draws follow the model of the likelihood: the regions of the fixes then contain the truth as
// often as stated (Talts et al., Validating Bayesian inference algorithms with simulation-based
// calibration, 2018).
TEST(ChannelDraw, FollowsTheModelOfTheLocalizer) {
  ModelError error;
  error.plan_tolerance = 0.002;
  error.diffuse = 0.15;
  error.diffuse_decay = 9e-9;
  error.noise = 1e-3;
  RoomModel room = room_with(error);
  room.likelihood_exponent = 1.0;
  room.sigma_floor = 0.001;
  const auto shared = std::make_shared<const RoomModel>(room);
  const auto localizer = Localizer::create(shared, {});
  ASSERT_TRUE(localizer);
  RandomStream random(5);
  ChannelDraw draws(room, 0, RandomStream(11));
  const auto within = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from + 0.05, to - 0.05)(random);
  };
  int half = 0;
  int most = 0;
  constexpr int kFixes = 100;
  for (int n = 0; n < kFixes; ++n) {
    const Vec3d place{within(room.bounds_min.x, room.bounds_max.x),
                      within(room.bounds_min.y, room.bounds_max.y),
                      room.device.height};
    const auto frames = test::frames_of(
        room, {draws.at({place, {}}, room.grid).h}, {.count = 1, .snr_db = 50.0, .seed = 2});
    const double reaching = region_reaching(localizer->locate(frames), place).value_or(1.0);
    half += reaching <= 0.5 ? 1 : 0;
    most += reaching <= 0.95 ? 1 : 0;
  }
  // Four standard deviations of a binomial.
  EXPECT_NEAR(half, 50, 20);
  EXPECT_GE(most, 86);
}

}  // namespace
}  // namespace rayloc::channel_draw_test
