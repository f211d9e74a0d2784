#include "engine/em/antenna_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/gradient_check.h"

namespace rayloc {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3d direction(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Gain averaged over the sphere.
double mean_gain(AntennaPattern pattern) {
  constexpr int kSteps = 2000;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double theta = (i + 0.5) * kPi / kSteps;
    const double amplitude = pattern_amplitude(pattern, std::cos(theta), std::sin(theta));
    sum += amplitude * amplitude * std::sin(theta) * kPi / kSteps;
  }
  return sum / 2.0;
}

TEST(AntennaField, RadiatesWhatItIsFed) {
  EXPECT_NEAR(mean_gain(AntennaPattern::kIsotropic), 1.0, 1e-6);
  EXPECT_NEAR(mean_gain(AntennaPattern::kDipole), 1.0, 1e-6);
  EXPECT_NEAR(mean_gain(AntennaPattern::kHalfWaveDipole), 1.0, 2e-3);  // 1.643 is rounded
}

TEST(AntennaField, IsTransversal) {
  const Mat3d tilted = rotation_from_yaw_pitch_roll(0.3, -0.2, 0.5);
  for (const auto polarization : {Polarization::kVertical, Polarization::kHorizontal}) {
    const Vec3d k = direction(1.1, -2.0);
    const Vec3d field = antenna_field(AntennaPattern::kIsotropic, polarization, tilted, k);
    EXPECT_NEAR(dot(field, k), 0.0, 1e-15);
    EXPECT_NEAR(norm(field), 1.0, 1e-15);
  }
}

TEST(AntennaField, DipoleIsSilentAlongItsAxis) {
  for (const auto pattern : {AntennaPattern::kDipole, AntennaPattern::kHalfWaveDipole}) {
    for (const Vec3d& axis : {Vec3d{0, 0, 1}, Vec3d{0, 0, -1}}) {
      EXPECT_EQ(norm(antenna_field(pattern, Polarization::kVertical, Mat3d{}, axis)), 0.0);
    }
    const Vec3d near = direction(1e-9, 0.4);
    EXPECT_NEAR(norm(antenna_field(pattern, Polarization::kVertical, Mat3d{}, near)), 0.0, 1e-8);
  }
}

TEST(AntennaField, HorizontalCrossesVertical) {
  const Vec3d k = direction(0.8, 0.3);
  const Vec3d v = antenna_field(AntennaPattern::kIsotropic, Polarization::kVertical, Mat3d{}, k);
  const Vec3d h = antenna_field(AntennaPattern::kIsotropic, Polarization::kHorizontal, Mat3d{}, k);
  EXPECT_NEAR(norm(cross(v, h) - k), 0.0, 1e-15);  // theta^ x phi^ = r^
}

TEST(AntennaField, GradientByOrientationMatchesFiniteDifferences) {
  const auto gain = [](const auto& x) {
    using T = std::decay_t<decltype(x[0])>;
    const Vec3<T> k{T(0.48), T(-0.6), T(0.64)};
    const Vec3<T> field = antenna_field(AntennaPattern::kHalfWaveDipole,
                                        Polarization::kVertical,
                                        rotation_from_yaw_pitch_roll(x[0], x[1], x[2]),
                                        k);
    return field.x + T(2.0) * field.y - field.z;
  };
  test::expect_gradient_matches<3>(gain, {0.3, -0.2, 0.5});
}

TEST(SphericalAngles, FollowTheConventions) {
  const SphericalAngles up = spherical_angles({0, 0, 2});
  EXPECT_EQ(up.theta, 0.0);
  EXPECT_EQ(up.phi, 0.0);
  const SphericalAngles y = spherical_angles({0, 3, 0});
  EXPECT_NEAR(y.theta, kPi / 2, 1e-15);
  EXPECT_NEAR(y.phi, kPi / 2, 1e-15);
}

}  // namespace
}  // namespace rayloc
