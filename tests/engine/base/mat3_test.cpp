#include "engine/base/mat3.h"

#include <gtest/gtest.h>

namespace rayloc::mat3_test {
namespace {

constexpr double kQuarterTurn = 1.5707963267948966;

void expect_near(const Vec3d& a, const Vec3d& b) { EXPECT_NEAR(norm(a - b), 0.0, 1e-15); }

TEST(Rotation, YawRotatesXToY) {
  expect_near(rotation_from_yaw_pitch_roll(kQuarterTurn, 0.0, 0.0) * Vec3d{1, 0, 0}, {0, 1, 0});
}
TEST(Rotation, PitchRotatesXDown) {
  expect_near(rotation_from_yaw_pitch_roll(0.0, kQuarterTurn, 0.0) * Vec3d{1, 0, 0}, {0, 0, -1});
}
TEST(Rotation, RollRotatesYToZ) {
  expect_near(rotation_from_yaw_pitch_roll(0.0, 0.0, kQuarterTurn) * Vec3d{0, 1, 0}, {0, 0, 1});
}
TEST(Rotation, RollComesFirst) {
  // Roll takes y to z, pitch z to x, yaw x to y.
  const Mat3d r = rotation_from_yaw_pitch_roll(kQuarterTurn, kQuarterTurn, kQuarterTurn);
  expect_near(r * Vec3d{0, 1, 0}, {0, 1, 0});
}
TEST(Rotation, TransposeInverts) {
  const Mat3d r = rotation_from_yaw_pitch_roll(0.3, -0.2, 0.5);
  const Vec3d v{1.0, -2.0, 0.5};
  expect_near(transpose_times(r, r * v), v);
}

}  // namespace
}  // namespace rayloc::mat3_test
