#include "engine/paper/person_localizer.h"

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/scene/scene.h"
#include "tests/support/person_in_room.h"

namespace rayloc::paper::person_localizer_test {
namespace {

// The expected person: the loss has the true body.
const TargetBody kBody = PersonModel{}.body;

class PaperPersonLocalizerTest : public ::testing::Test {
 protected:
  static const RoomModel& room() {
    static const RoomModel kRoom = test::make_room();
    return kRoom;
  }
  static const PersonReference& reference() {
    static const PersonReference kReference = test::learn_reference(room());
    return kReference;
  }
  static PersonLocalizer localizer(const LocalizerOptions& options = person_options(),
                                   const RoomModel& in = room(),
                                   const PersonReference& of = reference()) {
    return *PersonLocalizer::create(std::make_shared<const RoomModel>(in), of, options);
  }
  static std::vector<CsiFrame> frames_at(const TargetPosition& place, double snr_db = 40.0) {
    return test::frames_past(room(), {place}, kBody, {.count = 4, .snr_db = snr_db, .seed = 7});
  }
};

// The frames have waves of one reflection more than the method models, and the loss has many
// minima: at (-0.5, -0.4) it is 5.0, and 4.0 at 0.15 m from there.
TEST_F(PaperPersonLocalizerTest, LossIsLessWhereThePersonIsThanAround) {
  LocalizerOptions options = person_options();
  options.centre_weight = 0.0;
  const auto method = localizer(options);
  for (const Vec3d& truth : {Vec3d{0.3, 0.2, 0}, Vec3d{0.5, 0.5, 0}}) {
    const auto frames = frames_at({truth.x, truth.y}, 60.0);
    const double here = method.loss(frames, truth)->value;
    for (const Vec3d& off : {Vec3d{0.15, 0, 0}, Vec3d{0, -0.15, 0}, Vec3d{-0.3, 0.2, 0}}) {
      EXPECT_GT(method.loss(frames, truth + off)->value, here);
    }
  }
}

// Central differences of fourth order.
void expect_gradient_at(const PersonLocalizer& method,
                        const std::vector<CsiFrame>& frames,
                        const Vec3d& at) {
  const auto along = [&](const Vec3d& unit) {
    const auto value = [&](double off) { return method.loss(frames, at + off * unit)->value; };
    const double h = 2e-5;
    return (8.0 * (value(h) - value(-h)) - (value(2.0 * h) - value(-2.0 * h))) / (12.0 * h);
  };
  const LossInPlan found = *method.loss(frames, at);
  const double scale = std::hypot(found.by_x, found.by_y);
  EXPECT_NEAR(found.by_x, along({1, 0, 0}), 1e-5 * scale);
  EXPECT_NEAR(found.by_y, along({0, 1, 0}), 1e-5 * scale);
}

TEST_F(PaperPersonLocalizerTest, GradientMatchesDifferences) {
  const auto frames = frames_at({0.3, 0.2});
  const auto method = localizer();
  expect_gradient_at(method, frames, {0.31, 0.13, 0.0});
  expect_gradient_at(method, frames, {-0.6, -0.4, 0.0});
}

TEST_F(PaperPersonLocalizerTest, GradientHoldsWithScaleAndSurfaceCorrections) {
  RoomModel corrected = room();
  for (std::size_t i = 0; i < corrected.scene->surfaces().size(); ++i) {
    corrected.surface_correction.push_back(std::polar(0.5, 0.3 * static_cast<double>(i)));
  }
  PersonReference scaled = reference();
  for (PersonLink& link : scaled.links) {
    link.scale = std::polar(0.7, 0.8);
  }
  const auto frames = frames_at({0.3, 0.2});
  const Vec3d at{0.1, 0.1, 0.0};
  const double plain = localizer().loss(frames, at)->value;
  const auto with_corrections = localizer(person_options(), corrected);
  const auto with_scale = localizer(person_options(), room(), scaled);
  for (const auto* method : {&with_corrections, &with_scale}) {
    EXPECT_GT(std::abs(method->loss(frames, at)->value - plain), 0.01 * plain);
    expect_gradient_at(*method, frames, at);
  }
}

TEST_F(PaperPersonLocalizerTest, FindsThePersonFromNearby) {
  LocalizerOptions options = person_options();
  options.centre_weight = 0.0;
  options.descent.variance = 25e-6;  // 5 mm
  options.descent.least_deviation = 1e-3;
  options.descent.rate = 1e-3;
  for (const TargetPosition& truth : {TargetPosition{0.3, 0.2}, TargetPosition{-0.5, -0.4}}) {
    options.start = Vec3d{truth.x + 0.012, truth.y - 0.01, 0.0};
    const LocationEstimate estimate = localizer(options).locate(frames_at(truth));
    ASSERT_TRUE(estimate.position) << estimate.reason;
    EXPECT_LT(std::hypot(estimate.position->x - truth.x, estimate.position->y - truth.y), 0.01);
    EXPECT_EQ(estimate.position->z, room().bounds_min.z);
    EXPECT_EQ(estimate.access_points_used, 3U);
    EXPECT_EQ(estimate.iterations, 100U);
    EXPECT_LT(estimate.model_residual_db, -15.0);
  }
}

TEST_F(PaperPersonLocalizerTest, StatesNoUncertainty) {
  LocalizerOptions options = person_options();
  options.descent.iterations = 2;
  const auto estimate = localizer(options).locate(frames_at({0.3, 0.2}));
  ASSERT_TRUE(estimate.position);
  EXPECT_FALSE(estimate.is_uncertainty_stated);
  EXPECT_TRUE(estimate.hypotheses.empty());
  EXPECT_EQ(estimate.residual_probability, 1.0);
}

TEST_F(PaperPersonLocalizerTest, IsTheSameOnOneThreadAndOnTwo) {
  const auto frames = frames_at({0.3, 0.2});
  LocalizerOptions options = person_options();
  options.starts = 2;
  options.descent.iterations = 4;
  std::vector<Vec3d> found;
  for (const std::size_t threads : {1U, 2U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    found.push_back(*localizer(options).locate(frames).position);
  }
  EXPECT_EQ(found[0], found[1]);
  EXPECT_NE(found[0], *localizer(options).locate(frames, 2).position);  // another seed
}

TEST_F(PaperPersonLocalizerTest, KeepsTheBodyInTheRoom) {
  LocalizerOptions options = person_options();
  options.start = Vec3d{40.0, -40.0, 0.0};
  options.descent.iterations = 0;
  const auto estimate = localizer(options).locate(frames_at({0.3, 0.2}));
  ASSERT_TRUE(estimate.position);
  EXPECT_DOUBLE_EQ(estimate.position->x, room().bounds_max.x - kBody.semi_axes[0]);
  EXPECT_DOUBLE_EQ(estimate.position->y, room().bounds_min.y + kBody.semi_axes[0]);
}

// A body that would hold the transmitter changes nothing that could be computed.
TEST_F(PaperPersonLocalizerTest, GoesOnWhereTheBodyWouldHoldADevice) {
  const auto frames = frames_at({0.3, 0.2});
  const Vec3d device = test::fixed_transmitter().position;
  LocalizerOptions options = person_options();
  options.centre_weight = 0.0;
  const LossInPlan there = *localizer(options).loss(frames, device);
  EXPECT_GT(there.value, 0.0);
  EXPECT_EQ(there.by_x, 0.0);
  EXPECT_EQ(there.by_y, 0.0);
}

TEST_F(PaperPersonLocalizerTest, ReportsTheReasonForNoFix) {
  EXPECT_EQ(localizer().locate({}).reason, "no frames");
  EXPECT_FALSE(localizer().loss({}, {}));
}

TEST_F(PaperPersonLocalizerTest, RefusesInvalidInputs) {
  const auto shared = std::make_shared<const RoomModel>(room());
  LocalizerOptions bad = person_options();
  bad.starts = 0;
  EXPECT_FALSE(PersonLocalizer::create(shared, reference(), bad));
  EXPECT_FALSE(PersonLocalizer::create(nullptr, reference(), person_options()));
  EXPECT_FALSE(PersonLocalizer::create(shared, {}, person_options()));
  PersonReference other = reference();
  other.links[0].empty.pop_back();
  EXPECT_FALSE(PersonLocalizer::create(shared, other, person_options()));
}

}  // namespace
}  // namespace rayloc::paper::person_localizer_test
