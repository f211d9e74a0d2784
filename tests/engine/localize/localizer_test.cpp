#include "engine/localize/localizer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/support/synthetic_room.h"

namespace rayloc::localizer_test {
namespace {

std::shared_ptr<const RoomModel> shared(RoomModel room) {
  return std::make_shared<const RoomModel>(std::move(room));
}

// One map for all tests: building it is most of their time.
const Localizer& localizer() {
  static const Localizer kLocalizer = *Localizer::create(shared(test::make_room()), {});
  return kLocalizer;
}

double error_of(const LocationEstimate& estimate, const Vec3d& truth) {
  return std::hypot(estimate.position->x - truth.x, estimate.position->y - truth.y);
}

TEST(Localizer, FindsTheDevice) {
  for (const Vec3d truth : {Vec3d{0.3, 0.2, 1.2}, Vec3d{-0.9, -0.6, 1.2}, Vec3d{1.1, -0.4, 1.2}}) {
    const auto frames = test::frames_at(localizer().room(), truth);
    const LocationEstimate estimate = localizer().locate(frames);
    ASSERT_TRUE(estimate.position) << estimate.reason;
    EXPECT_LT(error_of(estimate, truth), 0.1);
    EXPECT_LE(error_of(estimate, truth), estimate.accuracy_m);
    EXPECT_EQ(estimate.position->z, 1.2);
    EXPECT_EQ(estimate.access_points_used, 3U);
    EXPECT_EQ(estimate.antennas_used, 9U);
    EXPECT_EQ(estimate.frames_used, 12U);
    EXPECT_NEAR(estimate.snr_db, 30.0, 2.0);
    EXPECT_EQ(estimate.time, Timestamp(std::chrono::milliseconds(15)));
    ASSERT_FALSE(estimate.hypotheses.empty());
    double sum = estimate.residual_probability;
    for (const Hypothesis& hypothesis : estimate.hypotheses) {
      EXPECT_LE(hypothesis.weight, estimate.hypotheses.front().weight);
      sum += hypothesis.weight;
    }
    EXPECT_NEAR(sum, 1.0, 1e-9);
  }
}

TEST(Localizer, FindsTheDeviceByEveryLikelihood) {
  const auto room = shared(test::make_room());
  const Vec3d truth{0.3, 0.2, 1.2};
  const auto frames = test::frames_at(*room, truth);
  for (const LikelihoodName& one : likelihood_names()) {
    LocalizerOptions options;
    options.likelihood = one.kind;
    const auto other = Localizer::create(room, options);
    ASSERT_TRUE(other);
    const LocationEstimate estimate = other->locate(frames);
    ASSERT_TRUE(estimate.position) << one.name << ": " << estimate.reason;
    // Amplitudes peak within millimetres of the place, and at other places as well.
    EXPECT_LT(error_of(estimate, truth), one.kind == LikelihoodKind::kRatioAmplitude ? 1.5 : 0.15)
        << one.name;
  }
}

TEST(Localizer, LeavesOutASingleAntennaWhereRatiosAreCompared) {
  RoomModel room = test::make_room();
  RoomAccessPoint& alone = room.access_points[1];
  alone.rx_chains.resize(1);
  alone.array.element_offset.resize(1);
  alone.gains.rx_chains.resize(1);
  alone.gains.gain.resize(room.grid.size());
  LocalizerOptions options;
  options.likelihood = LikelihoodKind::kRatioComplex;
  const auto by_ratio = Localizer::create(shared(room), options);
  ASSERT_TRUE(by_ratio);
  const auto estimate = by_ratio->locate(test::frames_at(test::make_room(), {0.3, 0.2, 1.2}));
  EXPECT_EQ(estimate.access_points_used, 2U);
  ASSERT_FALSE(estimate.warnings.empty());
  EXPECT_NE(estimate.warnings[0].find("access point b has a single antenna"), std::string::npos)
      << estimate.warnings[0];
}

// Places within a cell are distinguished: the cells are 5 cm.
TEST(Localizer, IsSharperThanItsCells) {
  RoomModel room = test::make_room();
  for (RoomAccessPoint& ap : room.access_points) {
    ap.error.plan_tolerance = 0.001;
    ap.error.diffuse = 0.005;
  }
  const auto sharp = Localizer::create(shared(room), {});
  ASSERT_TRUE(sharp);
  for (const Vec3d truth : {Vec3d{0.31, 0.22, 1.2}, Vec3d{-0.58, -0.43, 1.2}}) {
    const auto estimate = sharp->locate(test::frames_at(room, truth));
    ASSERT_TRUE(estimate.position) << estimate.reason;
    EXPECT_LT(error_of(estimate, truth), 0.01);
  }
}

TEST(Localizer, MapDecidesBetweenPlacesNotTheOrderOfTheFrames) {
  const Vec3d truth{0.4, -0.3, 1.2};
  auto frames = test::frames_at(localizer().room(), truth);
  const LocationEstimate before = localizer().locate(frames);
  std::stable_sort(frames.begin(), frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
    return a.time < b.time;
  });
  const LocationEstimate after = localizer().locate(frames);
  EXPECT_EQ(*before.position, *after.position);
  EXPECT_EQ(before.loss, after.loss);
}

TEST(Localizer, IsTheSameOnOneThreadAndOnTwo) {
  const auto room = shared(test::make_room());
  const auto frames = test::frames_at(*room, {0.2, 0.5, 1.2});
  std::vector<LocationEstimate> estimates;
  for (const std::size_t threads : {1U, 2U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const auto own = Localizer::create(room, {});
    ASSERT_TRUE(own);
    estimates.push_back(own->locate(frames));
    estimates.push_back(own->locate(frames));
  }
  for (const LocationEstimate& estimate : estimates) {
    ASSERT_TRUE(estimate.position);
    EXPECT_EQ(*estimate.position, *estimates[0].position);
    EXPECT_EQ(estimate.covariance, estimates[0].covariance);
    EXPECT_EQ(estimate.accuracy_m, estimates[0].accuracy_m);
    EXPECT_EQ(estimate.loss, estimates[0].loss);
    EXPECT_EQ(estimate.residual_probability, estimates[0].residual_probability);
  }
}

TEST(Localizer, WithOneAccessPointIsLessSure) {
  const Vec3d truth{0.3, 0.2, 1.2};
  const auto frames = test::frames_at(localizer().room(), truth);
  const LocationEstimate all = localizer().locate(frames);
  const LocationEstimate one = localizer().locate(std::span(frames).first(4));
  ASSERT_TRUE(one.position) << one.reason;
  EXPECT_EQ(one.access_points_used, 1U);
  EXPECT_GT(one.covariance[0] + one.covariance[4], all.covariance[0] + all.covariance[4]);
}

TEST(Localizer, GivesNoFixWithoutFrames) {
  const LocationEstimate estimate = localizer().locate({});
  EXPECT_FALSE(estimate.position);
  EXPECT_EQ(estimate.reason, "no frames");
  EXPECT_EQ(estimate.residual_probability, 1.0);
}

TEST(Localizer, GivesNoFixWithoutChainGains) {
  RoomModel room = test::make_room();
  for (RoomAccessPoint& ap : room.access_points) {
    ap.gains = {};
  }
  const auto uncalibrated = Localizer::create(shared(room), {});
  ASSERT_TRUE(uncalibrated);
  const auto estimate = uncalibrated->locate(test::frames_at(room, {0.3, 0.2, 1.2}));
  EXPECT_FALSE(estimate.position);
  EXPECT_EQ(estimate.reason, "no chain gains, calibrate the site");
  EXPECT_EQ(estimate.warnings.front(),
            "access point a has no chain gains: calibrate the site first (rayloc calibrate)");
}

TEST(Localizer, OmitsAndReportsAnAccessPointWithoutChainGains) {
  RoomModel room = test::make_room();
  room.access_points[1].gains = {};
  const Vec3d truth{0.3, 0.2, 1.2};
  const auto estimate = Localizer::create(shared(room), {})->locate(test::frames_at(room, truth));
  ASSERT_TRUE(estimate.position) << estimate.reason;
  EXPECT_EQ(estimate.access_points_used, 2U);
  ASSERT_EQ(estimate.warnings.size(), 1U);
  EXPECT_NE(estimate.warnings[0].find("access point b"), std::string::npos);
}

TEST(Localizer, GivesNoFixForNoise) {
  auto frames = test::frames_at(localizer().room(), {0.3, 0.2, 1.2}, {4, -40.0, 3});
  const LocationEstimate estimate = localizer().locate(frames);
  EXPECT_FALSE(estimate.position);
  EXPECT_FALSE(estimate.reason.empty());
}

TEST(Localizer, GivesNoFixForFramesItCannotRead) {
  auto frames = test::frames_at(localizer().room(), {0.3, 0.2, 1.2});
  for (CsiFrame& frame : frames) {
    frame.rx_chains = {0, 1, 2};
  }
  const LocationEstimate estimate = localizer().locate(frames);
  EXPECT_FALSE(estimate.position);
  EXPECT_NE(estimate.reason.find("missing_core"), std::string::npos) << estimate.reason;
}

TEST(Localizer, RefusesARoomThatCannotBeModelled) {
  EXPECT_FALSE(Localizer::create(nullptr, {}));
  RoomModel empty = test::make_room();
  empty.bounds_max = empty.bounds_min;
  EXPECT_FALSE(Localizer::create(shared(empty), {}));
  RoomModel deaf = test::make_room();
  deaf.access_points.clear();
  EXPECT_FALSE(Localizer::create(shared(deaf), {}));
}

}  // namespace
}  // namespace rayloc::localizer_test
