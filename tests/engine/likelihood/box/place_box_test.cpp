#include "engine/likelihood/box/place_box.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "engine/likelihood/known_rays.h"
#include "engine/likelihood/place_moments.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::place_box_test {
namespace {

class PlaceBoxes : public ::testing::Test {
 protected:
  PlaceBoxes()
      : room_(test::make_room()),
        model_(room_.grid, 3),
        offsets_(offsets_of(room_.access_points[0].array)),
        rays_(test::rays_to(PathTracer(room_.scene, room_.trace),
                            room_,
                            room_.access_points[0].array,
                            {0.4, -0.5, 1.2})) {}

  PlaceBox box(const BoxShape& shape, std::size_t rays = kBoxRays) const {
    return place_box(model_, {rays_, offsets_, 0.007, 0.0, 0.014}, ModelError{}, shape, rays);
  }

  RoomModel room_;
  ObservationModel model_;
  std::vector<Vec3d> offsets_;
  std::vector<Ray> rays_;
};

TEST_F(PlaceBoxes, ArePureFunctions) {
  const BoxShape shape{{0.025, -0.025, 0.0}, {0.05, 0.05, 0.15}};
  const PlaceBox one = box(shape);
  const PlaceBox other = box(shape);
  ASSERT_TRUE(one.is_reachable());
  EXPECT_TRUE(std::ranges::equal(one.block(), other.block()));
  EXPECT_EQ(one.log_determinant, other.log_determinant);
}

TEST_F(PlaceBoxes, KeepTheStrongestRays) {
  const BoxShape shape{{}, {0.05, 0.05, 0.15}};
  const PlaceBox few = box(shape, 4);
  EXPECT_EQ(few.size().rays, 4U);
  EXPECT_TRUE(few.has_direct);
  EXPECT_EQ(few.block().size(), PlaceBox::floats_of(few.size()));
  const auto power = [&](std::size_t p) {
    float sum = 0.0F;
    for (std::size_t i = 0; i < 2 * few.size().coordinates; ++i) {
      sum += few.mean(p)[i] * few.mean(p)[i];
    }
    return sum;
  };
  EXPECT_GE(power(1), power(2));
  EXPECT_GE(power(2), power(3));
  // The power of the other rays is in the covariance.
  EXPECT_GT(few.log_determinant, box(shape).log_determinant);
}

TEST_F(PlaceBoxes, MoveTheImagesToTheirMiddle) {
  const Vec3d shift{0.025, -0.05, 0.0};
  const PlaceBox there = box({{}, {0.05, 0.05, 0.15}}, 1);
  const PlaceBox moved = box({shift, {0.05, 0.05, 0.15}}, 1);
  EXPECT_NEAR(moved.ray(0)[0], there.ray(0)[0] - 0.025F, 1e-6F);
  EXPECT_NEAR(moved.ray(0)[1], there.ray(0)[1] + 0.05F, 1e-6F);
  EXPECT_EQ(moved.ray(0)[2], there.ray(0)[2]);
  EXPECT_EQ(moved.ray(0)[4], there.ray(0)[4]);  // the reference of phases
}

// Compares with the covariance of Eigen, in double precision.
TEST_F(PlaceBoxes, WhitenTheMomentsOfTheirRays) {
  const ObservationModel::Place place{rays_, offsets_, 0.007, 0.0, 0.014};
  const ModelError error;
  const auto terms = model_.ray_terms(place, error);
  const KnownRays known = known_rays(model_, place, terms, kBoxRays, 1e-6);
  PlaceMoments moments = unknown_moments(model_, place, error, terms, known);
  std::vector<std::complex<double>> s(model_.dimension());
  for (const std::size_t p : known.rays) {
    model_.put_array(place, terms, p, s);
    for (std::size_t i = 0; i < s.size(); ++i) {
      moments.mean.all(static_cast<Eigen::Index>(i)) += terms.parts[p].known * s[i];
    }
  }
  const PlaceModel exact =
      moments.factorised(3, model_.diffuse_covariance(error.diffuse_decay), error.noise);
  const PlaceBox made = box({{}, {0.05, 0.05, 0.15}});
  ASSERT_EQ(made.size().rays, known.rays.size());
  EXPECT_NEAR(made.log_determinant, static_cast<float>(exact.log_determinant), 1e-4F);
  float largest = 0.0F;
  for (const std::complex<float>& w : exact.whitener) {
    largest = std::max(largest, std::abs(w));
  }
  for (std::size_t i = 0; i < exact.whitener.size(); ++i) {
    EXPECT_NEAR(made.whitener()[2 * i], exact.whitener[i].real(), 1e-6F * largest) << i;
    EXPECT_NEAR(made.whitener()[2 * i + 1], exact.whitener[i].imag(), 1e-6F * largest) << i;
  }
  // Images use Ray::mirror, which is in single precision.
  for (std::size_t i = 0; i < model_.dimension(); ++i) {
    EXPECT_NEAR(made.middle()[2 * i], exact.mean[i].real(), 1e-4F * largest) << i;
    EXPECT_NEAR(made.middle()[2 * i + 1], exact.mean[i].imag(), 1e-4F * largest) << i;
  }
}

TEST_F(PlaceBoxes, AreUnreachableWithoutRays) {
  const PlaceBox none = place_box(model_, {{}, offsets_}, ModelError{}, {});
  EXPECT_FALSE(none.is_reachable());
  EXPECT_TRUE(none.block().empty());
}

TEST(NoiseClass, IsAFactorOfFourWide) {
  const double model = 2e-3;
  EXPECT_EQ(noise_class_of(0.0, model), 0);
  EXPECT_EQ(noise_class_of(0.19 * model, model), 0);
  EXPECT_EQ(noise_class_of(0.21 * model, model), 1);
  EXPECT_EQ(noise_class_of(model, model), 2);
  EXPECT_EQ(noise_class_of(1.9 * model, model), 2);
  EXPECT_EQ(noise_class_of(2.1 * model, model), 3);
  EXPECT_EQ(noise_class_of(1.0, 1e-9), kNoiseClasses - 1);
  EXPECT_EQ(noise_of_class(0, model), 0.0);
  for (int i = 1; i < kNoiseClasses; ++i) {
    EXPECT_DOUBLE_EQ(noise_of_class(i, model), model * std::pow(4.0, i - 2));
    EXPECT_EQ(noise_class_of(noise_of_class(i, model), model), i);
  }
}

}  // namespace
}  // namespace rayloc::place_box_test
