#include "engine/paper/calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include <tbb/task_arena.h>

#include "engine/observe/burst.h"
#include "engine/paper/evaluator.h"
#include "engine/paper/parameters.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::paper::calibration_test {
namespace {

constexpr double kEastOffset = -0.004;  // [m]
constexpr double kPermittivity = 6.5;   // of the walls as built; 5.24 in the plan

// The room as built: the east wall is displaced and the walls are of another concrete.
RoomModel as_built() {
  RoomModel room = test::make_room();
  Scene::Input input{room.scene->objects(), room.scene->materials(), room.scene->carrier_hz()};
  for (Vec3d& vertex : input.objects[1].mesh.vertices) {
    vertex.x += kEastOffset;
  }
  input.materials[0].relative_permittivity = kPermittivity;
  room.scene = std::make_shared<const Scene>(std::move(Scene::create(std::move(input)).value()));
  return room;
}

// Channels of the access points of `room` from a device on a grid of per_axis squared points; every
// fifth is held out.
std::vector<CalibrationPoint> survey(const RoomModel& room, int per_axis) {
  std::vector<CalibrationPoint> points;
  for (int i = 0; i < per_axis * per_axis; ++i) {
    const int row = i / per_axis;
    const int column = i % per_axis;
    CalibrationPoint point;
    point.position = {
        -1.1 + 2.2 * (row + 0.5) / per_axis, -0.9 + 1.8 * (column + 0.5) / per_axis, 1.2};
    point.held_out = i % 5 == 2;
    const auto frames =
        test::frames_at(room, point.position, {2, 40.0, static_cast<unsigned>(1 + i)});
    for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
      point.h.push_back(
          combine_burst(frames, {ap, room.grid, room.access_points[ap].rx_chains, {}}).value().h);
    }
    points.push_back(std::move(point));
  }
  return points;
}

const std::vector<CalibrationPoint>& survey_as_built() {
  static const std::vector<CalibrationPoint> kPoints = survey(as_built(), 5);
  return kPoints;
}

const RoomParameter& parameter(const RoomCalibration& calibration, const std::string& name) {
  const auto found = std::find_if(calibration.parameters.begin(),
                                  calibration.parameters.end(),
                                  [&](const RoomParameter& p) { return to_string(p.id) == name; });
  EXPECT_NE(found, calibration.parameters.end()) << name;
  return *found;
}

std::vector<double> numbers(const RoomCalibration& calibration) {
  std::vector<double> all;
  for (const RoomParameter& one : calibration.parameters) {
    all.push_back(one.value);
  }
  for (const CalibrationStep& step : calibration.history) {
    all.insert(all.end(), {step.loss, step.heldout});
  }
  for (const PointFit& fit : calibration.points) {
    all.insert(all.end(), {fit.before, fit.after});
  }
  return all;
}

// Gradients of the loss of all points by one parameter, against differences in scenes built anew.
void expect_gradients(double softness) {
  const RoomModel room = test::make_room();
  const TraceOptions tracing{.max_depth = 2, .softness = softness};
  const auto samples = gather_samples(room, survey_as_built(), tracing).value();
  const Loss loss(room.grid, {}, kRatioFloor);
  const Evaluator evaluator(room, samples.training, tracing, loss);
  const Parameters parameters(room.scene, samples.met);
  const auto losses = [&](const Parameters::Values& values) {
    return evaluator.evaluate(parameters.scene_with(values).value(), LossKind::kDelay, {}).value();
  };
  const auto by_objects =
      evaluator.evaluate(room.scene, LossKind::kDelay, parameters.objects()).value();
  const auto by_materials =
      evaluator.evaluate(room.scene, LossKind::kRatioAmplitude, parameters.materials()).value();
  double largest = 0.0;
  constexpr double kStep = 1e-8;  // small: the losses have many corners
  for (std::size_t i = 0; i < parameters.objects().size(); ++i) {
    auto above = parameters.initial();
    auto below = above;
    above.translation[i] += kStep;
    below.translation[i] -= kStep;
    const double numeric = (losses(above).delay - losses(below).delay) / (2.0 * kStep);
    EXPECT_NEAR(by_objects.gradient[i], numeric, 1e-4 * std::abs(numeric) + 1e-5) << i;
    largest = std::max(largest, std::abs(numeric));
  }
  EXPECT_GT(largest, 0.1);
  for (std::size_t i = 0; i < parameters.materials().size(); ++i) {
    auto above = parameters.initial();
    auto below = above;
    above.material[i] += kStep;
    below.material[i] -= kStep;
    const double numeric =
        (losses(above).ratio_amplitude - losses(below).ratio_amplitude) / (2.0 * kStep);
    ASSERT_GT(std::abs(numeric), 1e-4);
    EXPECT_NEAR(by_materials.gradient[i], numeric, 1e-3 * std::abs(numeric)) << i;
  }
}

TEST(PaperEvaluator, GradientsMatchDifferences) { expect_gradients(0.0); }

TEST(PaperEvaluator, GradientsMatchDifferencesWithSoftEdges) { expect_gradients(0.05); }

TEST(PaperCalibration, MovesTheRoomTowardsAsBuilt) {
  const auto calibration = calibrate(test::make_room(), survey_as_built(), {.iterations = 40});
  ASSERT_TRUE(calibration) << calibration.error().message;
  ASSERT_EQ(calibration->history.size(), 41U);
  double best = calibration->history.front().loss;
  for (const CalibrationStep& step : calibration->history) {
    best = std::min(best, step.loss);
  }
  EXPECT_LT(best, 0.5 * calibration->history.front().loss);
  EXPECT_NEAR(parameter(*calibration, "east.x").value, kEastOffset, 0.0015);
  EXPECT_NEAR(parameter(*calibration, "concrete.relative_permittivity").value, kPermittivity, 0.4);
}

TEST(PaperCalibration, ReportsEveryPointBeforeAndAfter) {
  const auto& points = survey_as_built();
  const auto calibration = calibrate(test::make_room(), points, {.iterations = 40});
  ASSERT_TRUE(calibration);
  ASSERT_EQ(calibration->points.size(), points.size() * 3);
  double before = 0.0;
  double after = 0.0;
  for (std::size_t i = 0; i < calibration->points.size(); ++i) {
    EXPECT_EQ(calibration->points[i].point, i / 3);
    EXPECT_EQ(calibration->points[i].access_point, i % 3);
    before += calibration->points[i].before;
    after += calibration->points[i].after;
  }
  EXPECT_GT(after, before);
}

TEST(PaperCalibration, KeepsARoomThatIsAsItsPlan) {
  const RoomModel room = test::make_room();
  const auto calibration = calibrate(room, survey(room, 3), {.iterations = 10});
  ASSERT_TRUE(calibration);
  EXPECT_LT(std::abs(parameter(*calibration, "east.x").value), 0.001);
  // The loss from noise and hard edges; the wrong plan of the other tests begins at 0.54.
  EXPECT_LT(calibration->history.front().loss, 0.2);
}

TEST(PaperCalibration, LearnsNothingFromPointsHeldOut) {
  auto points = survey_as_built();
  const auto with = calibrate(test::make_room(), points, {.iterations = 5});
  for (CalibrationPoint& point : points) {
    if (point.held_out) {
      for (auto& h : point.h) {
        std::reverse(h.begin(), h.end());
      }
    }
  }
  const auto other = calibrate(test::make_room(), points, {.iterations = 5});
  ASSERT_TRUE(with && other);
  for (std::size_t i = 0; i < with->parameters.size(); ++i) {
    EXPECT_EQ(with->parameters[i].value, other->parameters[i].value);
  }
  EXPECT_NE(with->history.back().heldout, other->history.back().heldout);
}

TEST(PaperCalibration, DoesNotDependOnThreads) {
  std::vector<std::vector<double>> results;
  for (const int threads : {1, 2}) {
    tbb::task_arena(threads).execute([&] {
      results.push_back(
          numbers(calibrate(test::make_room(), survey_as_built(), {.iterations = 4}).value()));
    });
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST(PaperCalibration, StopsWhenAskedWithTheBestSoFar) {
  int calls = 0;
  const auto stop_after_three = [&](const CalibrationProgress& progress) {
    EXPECT_EQ(progress.step.iteration, calls);
    EXPECT_EQ(progress.points, 20U);  // 20 of 25 points, three access points
    return ++calls < 4;
  };
  const auto stopped = calibrate(test::make_room(), survey_as_built(), {}, stop_after_three);
  const auto whole = calibrate(test::make_room(), survey_as_built(), {.iterations = 3});
  ASSERT_TRUE(stopped && whole);
  EXPECT_TRUE(stopped->interrupted);
  EXPECT_FALSE(whole->interrupted);
  EXPECT_EQ(numbers(*stopped), numbers(*whole));
}

TEST(PaperCalibration, KeepsMaterialsPhysical) {
  const RoomModel room = test::make_room();
  const Parameters parameters(room.scene, {true, true, true, true, true});
  auto values = parameters.initial();
  values.material = {0.4, -0.1};
  parameters.project(values);
  EXPECT_EQ(values.material, (std::vector<double>{1.0, 0.0}));
}

TEST(PaperCalibration, RefusesTooFewPoints) {
  auto points = survey(test::make_room(), 2);  // one of four is held out
  points[0].h[2].clear();
  for (CalibrationPoint& point : points) {
    point.h[0].clear();  // no burst: stays as it is
    point.held_out = false;
  }
  const auto calibration = calibrate(test::make_room(), points);
  ASSERT_FALSE(calibration);
  EXPECT_EQ(calibration.error().message,
            "access point c: 3 calibration points can be used, at least 4 are needed");
}

TEST(PaperCalibration, RefusesAnAccessPointWithoutGains) {
  RoomModel room = test::make_room();
  room.access_points[1].gains = {};
  const auto calibration = calibrate(room, survey_as_built());
  ASSERT_FALSE(calibration);
  EXPECT_NE(calibration.error().message.find("access point b: its chain gains"), std::string::npos)
      << calibration.error().message;
}

TEST(PaperCalibration, RefusesOptionsThatMakeNoSense) {
  const RoomModel room = test::make_room();
  for (const CalibrationOptions& bad : {CalibrationOptions{.iterations = -1},
                                        {.softness = std::nan("")},
                                        {.smoothing = {4, 2}},
                                        {.object_rate = 0.0},
                                        {.descent = {.momentum = 1.0}}}) {
    const auto calibration = calibrate(room, survey_as_built(), bad);
    ASSERT_FALSE(calibration);
    EXPECT_EQ(calibration.error().kind, ErrorKind::kUsage);
  }
}

}  // namespace
}  // namespace rayloc::paper::calibration_test
