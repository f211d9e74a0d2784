#include "engine/trace/image_method.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "engine/trace/field_calculator.h"
#include "engine/trace/interactions/reflection.h"
#include "tests/support/gradient_check.h"

namespace rayloc::image_method_test {
namespace {

// Two planes at right angles and two ends; with S and T in front of both.
const Plane<double> kFloor{{0, 0, 1}, 0.0};
const Plane<double> kWall{{-1, 0, 0}, -3.0};  // x = 3

TEST(ImageMethod, MatchesAnalyticCornerReflector) {
  const Vec3d source{1.0, 0.5, 2.0};
  const Vec3d target{0.4, -0.3, 1.2};
  const std::array<Plane<double>, 2> planes{kWall, kFloor};
  std::array<Vec3d, 4> v;
  reflection_vertices<double>(source, planes, target, v);
  EXPECT_NEAR(v[1].x, 3.0, 1e-15);
  EXPECT_NEAR(v[2].z, 0.0, 1e-15);
  // Twice mirrored at right angles: the length is that to the point opposite the edge.
  const double length = norm(v[1] - v[0]) + norm(v[2] - v[1]) + norm(v[3] - v[2]);
  const Vec3d opposite{6.0 - source.x, source.y, -source.z};
  EXPECT_NEAR(length, norm(target - opposite), 1e-14);
  // The outgoing ray comes back in parallel, seen along the edge.
  const Vec3d out = normalized(v[1] - v[0]);
  const Vec3d back = normalized(v[3] - v[2]);
  EXPECT_NEAR(back.x, -out.x, 1e-15);
  EXPECT_NEAR(back.y, out.y, 1e-15);
  EXPECT_NEAR(back.z, -out.z, 1e-15);
}

TEST(ImageMethod, WithoutPlanesIsTheStraightLine) {
  std::array<Vec3d, 2> v;
  reflection_vertices<double>({1, 2, 3}, {}, {4, 5, 6}, v);
  EXPECT_EQ(v[0], (Vec3d{1, 2, 3}));
  EXPECT_EQ(v[1], (Vec3d{4, 5, 6}));
}

const std::array<Interaction, 2> kTwoReflections{};

// A path over wall and floor as a function of everything that can move:
// x[0..2] target, x[3] offset of the wall, x[4] permittivity, x[5] conductivity part, x[6]
// thickness.
template <typename T>
PathCoefficient<T> wall_floor_path(const std::array<T, 7>& x) {
  const std::array<Plane<T>, 2> planes{Plane<T>{{T(-1), T(0), T(0)}, -x[3]},
                                       Plane<T>{{T(0), T(0), T(1)}, T(0)}};
  const Complex<T> permittivity{x[4], x[5]};
  const std::array<Facet<T>, 2> facets{Facet<T>{planes[0], permittivity, x[6]},
                                       Facet<T>{planes[1], permittivity, x[6]}};
  LinkEnd<T> transmitter;
  transmitter.position = {T(1.0), T(0.5), T(2.0)};
  transmitter.world_from_antenna = rotation_from_yaw_pitch_roll(T(0.3), T(-0.2), T(0.5));
  LinkEnd<T> receiver;
  receiver.position = {x[0], x[1], x[2]};
  receiver.pattern = AntennaPattern::kHalfWaveDipole;
  return path_coefficient<T>(kTwoReflections, facets, transmitter, receiver, T(0.0578));
}

constexpr std::array<double, 7> kAt{0.4, -0.3, 1.2, 3.0, 5.24, -0.58, 0.1};

TEST(FieldCalculator, GradientsOfLengthAndFieldMatchFiniteDifferences) {
  const auto length = [](const auto& x) { return wall_floor_path(x).length; };
  const auto real = [](const auto& x) {
    using T = std::decay_t<decltype(x[0])>;
    return T(1e3) * wall_floor_path(x).a.re;
  };
  const auto imaginary = [](const auto& x) {
    using T = std::decay_t<decltype(x[0])>;
    return T(1e3) * wall_floor_path(x).a.im;
  };
  test::expect_gradient_matches<7>(length, kAt, 1e-8);
  test::expect_gradient_matches<7>(real, kAt, 1e-7);
  test::expect_gradient_matches<7>(imaginary, kAt, 1e-7);
}

TEST(FieldCalculator, GradientIsFiniteWithoutLoss) {
  auto lossless = kAt;
  lossless[5] = 0.0;
  const auto power = [](const auto& x) {
    using T = std::decay_t<decltype(x[0])>;
    return T(1e6) * abs2(wall_floor_path(x).a);
  };
  test::expect_gradient_matches<7>(power, lossless, 1e-6);
}

// Straight down onto the floor and up again: the plane of incidence is undefined there, and the
// derivative by the position exists all the same.
TEST(FieldCalculator, GradientHoldsAtNormalIncidence) {
  const auto part = [](const auto& x) {
    using T = std::decay_t<decltype(x[0])>;
    const std::array<Facet<T>, 1> floor{
        Facet<T>{{{T(0), T(0), T(1)}, T(0)}, {T(5.24), T(-0.58)}, T(0.1)}};
    LinkEnd<T> from;  // rotated, so that straight down is broadside
    from.world_from_antenna = rotation_from_yaw_pitch_roll(T(0.7), T(1.5), T(0.0));
    LinkEnd<T> to = from;
    from.position = {T(0), T(0), T(2.0)};
    to.position = {x[0], x[1], x[2]};
    const std::array<Interaction, 1> reflection{};
    return T(1e3) * path_coefficient<T>(reflection, floor, from, to, T(0.0578)).a.re;
  };
  test::expect_gradient_matches<3>(part, {0.0, 0.0, 1.0}, 1e-6);
}

// Fermat: the length changes by the arriving direction when the target moves.
TEST(FieldCalculator, LengthGradientIsTheUnitDirection) {
  using Jet = ceres::Jet<double, 7>;
  std::array<Jet, 7> x;
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = Jet(kAt[i], static_cast<int>(i));
  }
  const std::array<Plane<double>, 2> planes{kWall, kFloor};
  std::array<Vec3d, 4> v;
  reflection_vertices<double>({1.0, 0.5, 2.0}, planes, {kAt[0], kAt[1], kAt[2]}, v);
  const Vec3d arriving = normalized(v[3] - v[2]);
  const Jet length = wall_floor_path(x).length;
  EXPECT_NEAR(length.v[0], arriving.x, 1e-14);
  EXPECT_NEAR(length.v[1], arriving.y, 1e-14);
  EXPECT_NEAR(length.v[2], arriving.z, 1e-14);
}

TEST(FieldCalculator, LosslessMirrorKeepsTheField) {
  const Facet<double> metal{{{0, 0, 1}, 0.0}, {1.0, -3e10}, 0.1};
  const Vec3d in = normalized(Vec3d{0.6, 0.2, -0.5});
  const Vec3d out{in.x, in.y, -in.z};
  const Vec3d across = normalized(cross(in, {0, 0, 1}));
  const ComplexVec3<double> field{0.3 * across + 0.8 * cross(across, in), {}};
  const auto reflected =
      interactions::Reflection::apply(Wave<double>{field, in}, metal, 0.0578).field;
  EXPECT_NEAR(norm(reflected.re), norm(field.re), 1e-4);
  EXPECT_NEAR(dot(reflected.re, out), 0.0, 1e-15);
  // A perfect conductor has no tangential field: incident and reflected cancel in the plane.
  EXPECT_NEAR(reflected.re.x + field.re.x, 0.0, 1e-4);
  EXPECT_NEAR(reflected.re.y + field.re.y, 0.0, 1e-4);
}

}  // namespace
}  // namespace rayloc::image_method_test
