#include "engine/person/path_errors.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/person/person_likelihood.h"
#include "engine/person/triangle.h"
#include "tests/support/person_in_room.h"

namespace rayloc::path_errors_test {
namespace {

using Value = std::complex<double>;

ScatteredRay ray(std::size_t path, double turn_x) {
  ScatteredRay result;
  result.slope_x = {0.0, turn_x};
  result.path = path;
  return result;
}

const Value& cross(const std::vector<Value>& triangle) { return triangle[triangle_size(1)]; }

TEST(PathErrors, AreAlikeAtAllAntennasOfAPath) {
  const std::vector<Value> one{1.0};
  PathErrors same(2, 1);
  same.add(0, ray(0, 0.0), {1.0, 0.0}, one, 1.0);
  same.add(1, ray(0, 0.0), {0.0, 2.0}, one, 1.0);
  const auto all = same.all(0.015);
  EXPECT_EQ(all[0], Value(1.0));
  EXPECT_EQ(cross(all), Value(0.0, 2.0));
  EXPECT_EQ(all[2], Value(4.0));

  PathErrors other(2, 1);
  other.add(0, ray(0, 0.0), {1.0, 0.0}, one, 1.0);
  other.add(1, ray(1, 0.0), {0.0, 2.0}, one, 1.0);
  EXPECT_EQ(cross(other.all(0.015)), Value(0.0));
}

TEST(PathErrors, LoseThePhaseThatVariesWithinTheCell) {
  const std::vector<Value> one{1.0};
  PathErrors errors(2, 1);
  errors.add(0, ray(0, -10.0), {1.0, 0.0}, one, 0.25);
  errors.add(1, ray(0, 10.0), {1.0, 0.0}, one, 0.25);
  const double sigma = 0.05;  // [m]: a turn of one radian against each other
  EXPECT_NEAR(cross(errors.all(sigma)).real(), std::exp(-0.5), 1e-12);
  EXPECT_NEAR(errors.all(sigma)[0].real(), 1.0, 1e-12);
  // A quarter of the power has no phase.
  EXPECT_NEAR(cross(errors.without_phase(sigma)).real(), 0.25 * std::exp(-0.5), 1e-12);
}

// A wave scattered back depends on the place of the body's front, a wave that passes on does not.
TEST(PathErrors, AFrontOffsetAffectsOnlyBackscatteredPhases) {
  const RoomModel room = test::make_room();
  const PersonReference reference = test::learn_reference(room);
  const std::size_t antennas = room.access_points[0].rx_chains.size();
  const PersonLikelihood likelihood(room.grid, antennas, reference.links[0], 2.0);
  const auto power = [&](double turn, double front_offset_sigma) {
    ScatteredRay one = ray(0, turn);
    one.amplitude = 1.0;
    one.length = 2.0;
    const ScatteredRays rays(antennas, std::vector<ScatteredRay>(1, one));
    const auto patch = likelihood.patch(rays, {0.0, 0.0, 0.01, 1}, front_offset_sigma);
    double known = 0.0;
    for (const auto& value : patch.sample) {
      known += static_cast<double>(std::norm(value));
    }
    double unknown = 0.0;
    for (std::size_t i = 0; i < likelihood.dimension(); ++i) {
      unknown += patch.front[triangle_size(i + 1) - 1].real();
    }
    return std::array{known, unknown};
  };
  const auto [all, none] = power(0.0, 0.03);
  EXPECT_GT(all, 0.0);
  EXPECT_EQ(none, 0.0);
  const auto [known, unknown] = power(200.0, 0.03);
  EXPECT_LT(known, 1e-6 * all);
  EXPECT_NEAR(unknown, all, 1e-3 * all);
  EXPECT_NEAR(power(200.0, 0.0)[0], all, 1e-3 * all);
}

}  // namespace
}  // namespace rayloc::path_errors_test
