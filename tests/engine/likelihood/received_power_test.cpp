#include "engine/likelihood/received_power.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

namespace rayloc::received_power_test {
namespace {

const MacAddress kKnown = *parse_mac_address("02:52:4c:00:00:01");
const MacAddress kOther = *parse_mac_address("02:52:4c:00:00:02");

Ray ray_of(std::complex<double> amplitude, double length) {
  Ray ray;
  ray.amplitude = amplitude;
  ray.length = length;
  return ray;
}

RoomAccessPoint access_point() {
  RoomAccessPoint ap;
  ap.powers = {{kOther, -20.0, 1.0}, {kKnown, -37.5, 2.5}};
  return ap;
}

BurstObservation burst_of(const MacAddress& transmitter, std::optional<double> power_dbm) {
  BurstObservation burst;
  burst.transmitter = transmitter;
  burst.power_dbm = power_dbm;
  return burst;
}

TEST(ReceivedPower, AddsThePowersOfTheRaysWithoutTheirPhases) {
  ModelError error;
  error.diffuse = 0.0;
  // Two of equal strength that cancel each other: twice the power of one.
  const std::vector<Ray> rays = {ray_of({0.01, 0.0}, 2.0), ray_of({-0.01, 0.0}, 5.0)};
  EXPECT_NEAR(traced_power_db(rays, error), -40.0 + 10.0 * std::log10(2.0), 1e-12);
}

TEST(ReceivedPower, HasDiffusePowerByTheLengthOfTheShortestRay) {
  ModelError error;
  error.diffuse = 0.2;
  error.diffuse_exponent = 2.0;
  // Strongest first, as rays are: the shortest is not the strongest here. (6 m / 3 m)^2 * 0.2.
  const std::vector<Ray> rays = {ray_of({0.0, 0.003}, 9.0), ray_of({0.001, 0.0}, 6.0)};
  EXPECT_NEAR(traced_power_db(rays, error), 10.0 * std::log10((9e-6 + 1e-6) * 1.8), 1e-12);
}

TEST(ReceivedPower, IsAGaussianOfReceivedMinusTracedPower) {
  const auto received = received_power(access_point(), burst_of(kKnown, -81.0));
  ASSERT_TRUE(received);
  EXPECT_DOUBLE_EQ(received->traced_db, -43.5);
  EXPECT_DOUBLE_EQ(received->sigma_db, 2.5);
  EXPECT_DOUBLE_EQ(received->log_likelihood(-43.5), 0.0);
  EXPECT_DOUBLE_EQ(received->log_likelihood(-46.0), -0.5);  // one sigma
  EXPECT_DOUBLE_EQ(received->log_likelihood(-38.5), -2.0);  // two
}

TEST(ReceivedPower, IsAbsentForAnUnknownTransmitter) {
  const MacAddress stranger = *parse_mac_address("02:52:4c:00:00:03");
  EXPECT_FALSE(received_power(access_point(), burst_of(stranger, -81.0)));
  EXPECT_FALSE(received_power(RoomAccessPoint(), burst_of(kKnown, -81.0)));
}

TEST(ReceivedPower, IsAbsentIfTheBurstStatesNoPower) {
  EXPECT_FALSE(received_power(access_point(), burst_of(kKnown, std::nullopt)));
}

}  // namespace
}  // namespace rayloc::received_power_test
