#include "daemon/lab/simulate/rotations.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace rayloc::rotations_test {
namespace {

constexpr double kPi = std::numbers::pi;

void expect_near(const Vec3d& a, const Vec3d& b) {
  EXPECT_NEAR(a.x, b.x, 1e-12);
  EXPECT_NEAR(a.y, b.y, 1e-12);
  EXPECT_NEAR(a.z, b.z, 1e-12);
}

TEST(Rotations, KeepTheirAxisAndRotateOtherVectors) {
  expect_near(rotation_about({0, 0, 1}, kPi / 2) * Vec3d{1, 0, 0}, {0, 1, 0});
  expect_near(rotation_about({0, 1, 0}, kPi / 2) * Vec3d{0, 0, 1}, {1, 0, 0});
  const Vec3d axis = normalized(Vec3d{1, -2, 0.5});
  expect_near(rotation_about(axis, 0.7) * axis, axis);
  const Mat3d there_and_back = rotation_about(axis, 0.7) * rotation_about(axis, -0.7);
  expect_near(there_and_back * Vec3d{0.3, 0.4, 0.5}, {0.3, 0.4, 0.5});
}

// An access point that looks straight down has no yaw and roll of its own, only their sum.
TEST(Rotations, YawPitchAndRollGiveTheRotationBack) {
  for (const Orientation& o : {Orientation{0.4, -0.3, 2.0},
                               Orientation{-2.9, 1.2, -0.1},
                               Orientation{0.7, kPi / 2, 0.2},
                               Orientation{0.7, -kPi / 2, 0.2}}) {
    const Mat3d wanted = rotation(o);
    const Mat3d found = rotation(orientation_of(wanted));
    for (const Vec3d& v : {Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
      EXPECT_LT(norm(found * v - wanted * v), 1e-6);
    }
  }
}

}  // namespace
}  // namespace rayloc::rotations_test
