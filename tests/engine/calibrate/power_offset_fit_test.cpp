#include "engine/calibrate/power_offset_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "engine/likelihood/received_power.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::power_offset_fit_test {
namespace {

constexpr std::size_t kReceivedBy = 1;
constexpr double kOffset = -37.25;  // [dB]

const RoomModel& room() {
  static const RoomModel kRoom = test::make_room();
  return kRoom;
}

// Power that reaches the middle of the array of the access point, and diffuse power with it [dB].
double power_at(const Vec3d& position) {
  const RoomAccessPoint& ap = room().access_points[kReceivedBy];
  const Paths paths = PathTracer(room().scene, room().trace)
                          .trace(Transmitter{{position, {}, room().device.pattern}},
                                 Receiver{{ap.array.pose.position,
                                           ap.array.pose.orientation,
                                           ap.array.pattern,
                                           ap.array.polarization}});
  double power = 0.0;
  for (const Path& path : paths) {
    power += path.a.re * path.a.re + path.a.im * path.a.im;
  }
  return 10.0 * std::log10(power * (1.0 + ap.error.diffuse));
}

// At random places, with powers that the given ones are off, place by place.
std::vector<PowerSample> samples_off(const std::vector<double>& off) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<PowerSample> samples;
  for (const double one : off) {
    const double x = 1.2 * uniform(random);
    const Vec3d place{x, 0.8 * uniform(random), 1.2};
    samples.push_back({place, power_at(place) + kOffset + one});
  }
  return samples;
}

TEST(PowerOffsetFit, RecoversTheOffsetAndTheSpread) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<double> off(400);
  for (double& one : off) {
    one = 2.5 * normal(random);
  }
  const auto fit = fit_power_offset(room(), kReceivedBy, samples_off(off));
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->samples, 400U);
  EXPECT_NEAR(fit->offset_db, kOffset, 4.0 * 2.5 / 20.0);  // four standard errors
  EXPECT_NEAR(fit->sigma_db, 2.5, 4.0 * 2.5 / std::sqrt(800.0));
}

TEST(PowerOffsetFit, IsTheMeanAndTheUnbiasedDeviation) {
  std::vector<double> off(5, 3.0);
  off.resize(10, -1.0);
  const auto fit = fit_power_offset(room(), kReceivedBy, samples_off(off));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->offset_db, kOffset + 1.0, 1e-6);
  EXPECT_NEAR(fit->sigma_db, std::sqrt(10.0 * 4.0 / 9.0), 1e-6);
}

// Powers in whole decibels have no smaller error.
TEST(PowerOffsetFit, StatesNoSpreadBelowThatOfTheReadings) {
  const auto fit = fit_power_offset(room(), kReceivedBy, samples_off(std::vector<double>(20, 0.0)));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->offset_db, kOffset, 1e-6);
  EXPECT_EQ(fit->sigma_db, 0.5);
}

TEST(PowerOffsetFit, TakesAtLeastTenPoints) {
  const auto samples = samples_off(std::vector<double>(10, 0.0));
  EXPECT_TRUE(fit_power_offset(room(), kReceivedBy, samples));
  EXPECT_FALSE(fit_power_offset(room(), kReceivedBy, std::span(samples).first(9)));
  EXPECT_FALSE(fit_power_offset(room(), kReceivedBy, {}));
}

TEST(PowerOffsetFit, CountsOnlyPointsThatARayLeadsTo) {
  auto samples = samples_off(std::vector<double>(10, 0.0));
  samples[0].position = {0.0, 0.0, -5.0};  // below the floor
  EXPECT_FALSE(fit_power_offset(room(), kReceivedBy, samples));
  samples.push_back(samples[1]);
  const auto fit = fit_power_offset(room(), kReceivedBy, samples);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->samples, 10U);
  EXPECT_NEAR(fit->offset_db, kOffset, 1e-6);
}

}  // namespace
}  // namespace rayloc::power_offset_fit_test
