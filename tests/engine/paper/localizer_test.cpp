#include "engine/paper/localizer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <memory>
#include <vector>

#include "engine/scene/scene.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::paper::localizer_test {
namespace {

constexpr double kHeight = 1.2;  // of the device, in the synthetic room

std::shared_ptr<const RoomModel> shared(RoomModel room) {
  return std::make_shared<const RoomModel>(std::move(room));
}

Localizer localizer(const LocalizerOptions& options = {},
                    const RoomModel& room = test::make_room()) {
  return *Localizer::create(shared(room), options);
}

double error_of(const LocationEstimate& estimate, const Vec3d& truth) {
  return std::hypot(estimate.position->x - truth.x, estimate.position->y - truth.y);
}

TEST(PaperLocalizer, LossIsLeastWhereTheDeviceIs) {
  LocalizerOptions options;
  options.centre_weight = 0.0;
  const RoomModel room = test::make_room();
  const auto method = localizer(options, room);
  const Vec3d truth{0.3, 0.2, kHeight};
  const auto frames = test::frames_at(room, truth, {.snr_db = 60.0});
  const double here = method.loss(frames, truth)->value;
  EXPECT_LT(here, 0.01);
  for (const Vec3d& off : {Vec3d{0.1, 0, 0}, Vec3d{0, -0.1, 0}, Vec3d{-0.8, 0.3, 0}}) {
    EXPECT_GT(method.loss(frames, truth + off)->value, 5.0 * here);
  }
}

// Central differences of fourth order. The synthetic room has no edge between an access point and
// these places.
void expect_gradient_at(const Localizer& method,
                        const std::vector<CsiFrame>& frames,
                        const Vec3d& at) {
  const auto along = [&](const Vec3d& unit) {
    const auto value = [&](double off) { return method.loss(frames, at + off * unit)->value; };
    const double h = 2e-5;
    return (8.0 * (value(h) - value(-h)) - (value(2.0 * h) - value(-2.0 * h))) / (12.0 * h);
  };
  const LossInPlan found = *method.loss(frames, at);
  const double scale = std::hypot(found.by_x, found.by_y);
  EXPECT_NEAR(found.by_x, along({1, 0, 0}), 1e-6 * scale);
  EXPECT_NEAR(found.by_y, along({0, 1, 0}), 1e-6 * scale);
}

TEST(PaperLocalizer, GradientOfTheWholeLossMatchesDifferences) {
  const RoomModel room = test::make_room();
  const auto frames = test::frames_at(room, {0.3, 0.2, kHeight});
  LocalizerOptions heavy;  // each term counts
  heavy.csi.delay_weight = 1.0;
  heavy.centre_weight = 2.0;
  for (const LocalizerOptions& options : {LocalizerOptions{}, heavy}) {
    const auto method = localizer(options, room);
    for (const Vec3d at : {Vec3d{0.31, 0.13, kHeight}, Vec3d{-0.7, -0.4, kHeight}}) {
      expect_gradient_at(method, frames, at);
    }
  }
}

TEST(PaperLocalizer, GradientHoldsWithSurfaceCorrections) {
  RoomModel room = test::make_room();
  const auto frames = test::frames_at(room, {0.3, 0.2, kHeight});
  const double before = localizer({}, room).loss(frames, {0.1, 0.1, kHeight})->value;
  for (std::size_t i = 0; i < room.scene->surfaces().size(); ++i) {
    room.surface_correction.push_back(std::polar(0.5, 0.3 * static_cast<double>(i)));
  }
  const auto method = localizer({}, room);
  EXPECT_GT(std::abs(method.loss(frames, {0.1, 0.1, kHeight})->value - before), 0.1 * before);
  expect_gradient_at(method, frames, {0.1, 0.1, kHeight});
}

TEST(PaperLocalizer, PullsToTheMiddleOfTheRoomWhereverItsOriginIs) {
  LocalizerOptions without;
  without.centre_weight = 0.0;
  RoomModel room = test::make_room();
  room.bounds_max.x += 1.0;  // the middle is at 0.5, 0
  const auto frames = test::frames_at(room, {0.3, 0.2, kHeight});
  const Vec3d at{1.1, -0.4, kHeight};
  const double pull = localizer({}, room).loss(frames, at)->value -
                      localizer(without, room).loss(frames, at)->value;
  EXPECT_NEAR(pull, 0.05 * (0.6 * 0.6 + 0.4 * 0.4), 1e-9);
}

TEST(PaperLocalizer, FindsTheDeviceFromNearby) {
  // The loss ripples with the wavelength: the start is in the right dip, small steps stay there.
  LocalizerOptions options;
  options.descent.variance = 25e-6;  // 5 mm
  options.descent.least_deviation = 1e-3;
  options.descent.rate = 1e-3;
  const RoomModel room = test::make_room();
  for (const Vec3d truth :
       {Vec3d{0.3, 0.2, kHeight}, Vec3d{-0.5, -0.4, kHeight}, Vec3d{0.9, -0.7, kHeight}}) {
    options.start = truth + Vec3d{0.01, -0.008, 0.0};
    const LocationEstimate estimate = localizer(options, room).locate(test::frames_at(room, truth));
    ASSERT_TRUE(estimate.position) << estimate.reason;
    EXPECT_LT(error_of(estimate, truth), 0.005);
    EXPECT_EQ(estimate.position->z, kHeight);
    EXPECT_EQ(estimate.access_points_used, 3U);
    EXPECT_EQ(estimate.antennas_used, 9U);
    EXPECT_EQ(estimate.frames_used, 12U);
    EXPECT_EQ(estimate.iterations, 100U);
    EXPECT_EQ(estimate.starts, 1U);
    EXPECT_NEAR(estimate.snr_db, 30.0, 2.0);
    EXPECT_EQ(estimate.time, Timestamp(std::chrono::milliseconds(15)));
    EXPECT_LT(estimate.model_residual_db, -20.0);
  }
}

TEST(PaperLocalizer, StatesNoUncertainty) {
  const RoomModel room = test::make_room();
  const auto estimate = localizer({}, room).locate(test::frames_at(room, {0.3, 0.2, kHeight}));
  ASSERT_TRUE(estimate.position);
  EXPECT_FALSE(estimate.is_uncertainty_stated);
  EXPECT_TRUE(estimate.hypotheses.empty());
  EXPECT_EQ(estimate.residual_probability, 1.0);
}

TEST(PaperLocalizer, SeedAndTimeDecideTheStart) {
  const RoomModel room = test::make_room();
  auto frames = test::frames_at(room, {0.3, 0.2, kHeight});
  LocalizerOptions options;
  options.descent.iterations = 0;  // the start itself
  const auto first = localizer(options, room).locate(frames);
  EXPECT_EQ(*first.position, *localizer(options, room).locate(frames).position);
  options.seed = 2;
  EXPECT_NE(*first.position, *localizer(options, room).locate(frames).position);
  options.seed = 1;
  for (CsiFrame& frame : frames) {
    frame.time += std::chrono::seconds(1);
  }
  EXPECT_NE(*first.position, *localizer(options, room).locate(frames).position);
}

TEST(PaperLocalizer, IsTheSameOnOneThreadAndOnTwo) {
  const RoomModel room = test::make_room();
  const auto frames = test::frames_at(room, {0.2, 0.5, kHeight});
  LocalizerOptions options;
  options.starts = 3;
  options.descent.iterations = 20;
  std::vector<LocationEstimate> estimates;
  for (const std::size_t threads : {1U, 2U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const auto own = localizer(options, room);
    estimates.push_back(own.locate(frames));
    estimates.push_back(own.locate(frames));
  }
  for (const LocationEstimate& estimate : estimates) {
    ASSERT_TRUE(estimate.position);
    EXPECT_EQ(*estimate.position, *estimates[0].position);
    EXPECT_EQ(estimate.loss, estimates[0].loss);
    EXPECT_EQ(estimate.model_residual_db, estimates[0].model_residual_db);
  }
}

TEST(PaperLocalizer, MoreStartsNeverEndHigher) {
  const RoomModel room = test::make_room();
  const auto frames = test::frames_at(room, {-0.9, -0.6, kHeight});
  LocalizerOptions options;
  options.descent.iterations = 20;
  const double one = localizer(options, room).locate(frames).loss;
  options.starts = 6;
  const LocationEstimate best = localizer(options, room).locate(frames);
  EXPECT_LT(best.loss, one);
  EXPECT_EQ(best.starts, 6U);
}

TEST(PaperLocalizer, AblationsChangeTheEstimate) {
  const RoomModel room = test::make_room();
  const auto frames = test::frames_at(room, {0.3, 0.2, kHeight});
  LocalizerOptions options;
  const Vec3d whole = *localizer(options, room).locate(frames).position;
  options.descent.is_deviation_fixed = true;
  const Vec3d fixed = *localizer(options, room).locate(frames).position;
  options.descent.is_smoothed = false;
  const Vec3d plain = *localizer(options, room).locate(frames).position;
  EXPECT_NE(whole, fixed);
  EXPECT_NE(whole, plain);
  EXPECT_NE(fixed, plain);
}

TEST(PaperLocalizer, StaysInTheRoom) {
  const RoomModel room = test::make_room();
  LocalizerOptions options;
  options.start = Vec3d{40.0, -40.0, kHeight};
  options.descent.iterations = 0;
  const auto estimate =
      localizer(options, room).locate(test::frames_at(room, {1.4, -1.1, kHeight}));
  ASSERT_TRUE(estimate.position);
  EXPECT_DOUBLE_EQ(estimate.position->x, room.bounds_max.x - 0.01);
  EXPECT_DOUBLE_EQ(estimate.position->y, room.bounds_min.y + 0.01);
}

TEST(PaperLocalizer, ReportsTheReasonForNoFix) {
  RoomModel room = test::make_room();
  const auto frames = test::frames_at(room, {0.3, 0.2, kHeight});
  EXPECT_EQ(localizer().locate({}).reason, "no frames");
  EXPECT_FALSE(localizer().loss({}, {0, 0, kHeight}));
  for (RoomAccessPoint& ap : room.access_points) {
    ap.gains = {};
  }
  const auto estimate = localizer({}, room).locate(frames);
  EXPECT_FALSE(estimate.position);
  EXPECT_EQ(estimate.reason, "no chain gains, calibrate the site");
}

TEST(PaperLocalizer, LeavesOutASingleAntenna) {
  RoomModel room = test::make_room();
  RoomAccessPoint& ap = room.access_points[0];
  ap.array.element_offset.resize(1);
  ap.rx_chains.resize(1);
  ap.gains.rx_chains.resize(1);
  ap.gains.gain.resize(room.grid.size());
  const auto estimate =
      localizer({}, room).locate(test::frames_at(test::make_room(), {0.3, 0.2, kHeight}));
  ASSERT_TRUE(estimate.position);
  EXPECT_EQ(estimate.access_points_used, 2U);
  ASSERT_EQ(estimate.warnings.size(), 1U);
  EXPECT_EQ(estimate.warnings[0],
            "access point a has a single antenna, and there is no ratio of one");
}

TEST(PaperLocalizer, RefusesInvalidOptions) {
  EXPECT_FALSE(Localizer::create(nullptr, {}));
  std::vector<LocalizerOptions> bad(5);
  bad[0].starts = 0;
  bad[1].centre_weight = -1.0;
  bad[2].csi.floor = 0.0;
  bad[3].csi.smoothing.window = 4;
  bad[4].descent.rate = 0.0;
  for (std::size_t i = 0; i < bad.size(); ++i) {
    EXPECT_FALSE(Localizer::create(shared(test::make_room()), bad[i])) << i;
  }
}

}  // namespace
}  // namespace rayloc::paper::localizer_test
