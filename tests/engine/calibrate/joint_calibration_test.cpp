// Rooms of known truth, calibrated: how near the truth is what is found, and how honestly stated.
#include "engine/calibrate/joint/joint_calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "engine/base/constants.h"
#include "engine/calibrate/joint/stated_parameter.h"
#include "tests/support/surveyed_room.h"

namespace rayloc::joint_calibration_test {
namespace {

JointCalibrationOptions options_of(const test::SurveyedRoom& room) {
  JointCalibrationOptions options;
  options.trace = room.plan.trace;
  options.use = room.plan.trace;
  return options;
}

// Mean correlation over the points that no fit has seen.
double held_out_fit(const test::SurveyedRoom& room,
                    const RoomCalibration& calibration,
                    double PointFit::*of) {
  double sum = 0.0;
  int count = 0;
  for (const PointFit& fit : calibration.points) {
    if (room.points[fit.point].held_out) {
      sum += fit.*of;
      ++count;
    }
  }
  return sum / count;
}

// "a.core0/core2.phase" [deg] or ".gain" [dB], as near to the prior as it gets; nothing of others.
std::optional<double> chain_truth(const test::SurveyedRoom& room, const RoomParameter& parameter) {
  if (parameter.unit != "deg" && parameter.unit != "dB") {
    return std::nullopt;
  }
  for (const RoomAccessPoint& ap : room.built.access_points) {
    for (std::size_t rx_chain = 1; rx_chain < ap.rx_chains.size(); ++rx_chain) {
      const std::string name = ap.id + ".core" + std::to_string(ap.rx_chains[rx_chain]) + "/core" +
                               std::to_string(ap.rx_chains[0]);
      const std::complex<double> ratio = chain_ratio(ap.gains, rx_chain);
      if (to_string(parameter.id) == name + ".gain") {
        return 20.0 * std::log10(std::abs(ratio));
      }
      if (to_string(parameter.id) == name + ".phase") {
        return parameter.prior + std::remainder(std::arg(ratio) / kDegree - parameter.prior, 360.0);
      }
    }
  }
  return std::nullopt;
}

double truth_of(const test::SurveyedRoom& room, const RoomParameter& parameter) {
  if (const auto chain = chain_truth(room, parameter)) {
    return *chain;
  }
  const auto known = room.truth.find(to_string(parameter.id));
  return known == room.truth.end() ? parameter.prior : known->second;
}

double error_of(const test::SurveyedRoom& room,
                const RoomCalibration& calibration,
                const std::string& name) {
  for (const RoomParameter& parameter : calibration.parameters) {
    if (to_string(parameter.id) == name) {
      return parameter.value - truth_of(room, parameter);
    }
  }
  ADD_FAILURE() << "no parameter " << name;
  return 0.0;
}

double chain_phase(const RoomAccessPoint& ap, std::size_t rx_chain) {
  return std::arg(chain_ratio(ap.gains, rx_chain));
}

// No number may be stated more surely than the truth allows.
void expect_honest(const test::SurveyedRoom& room, const RoomCalibration& calibration) {
  double sum = 0.0;
  int count = 0;
  for (const RoomParameter& parameter : calibration.parameters) {
    if (parameter.sigma == 0.0) {
      EXPECT_EQ(parameter.value, parameter.prior) << to_string(parameter.id);  // nothing is known
      continue;
    }
    const double z = (parameter.value - truth_of(room, parameter)) / parameter.sigma;
    EXPECT_LT(std::abs(z), 4.0) << to_string(parameter.id) << " " << parameter.value << ", truth "
                                << truth_of(room, parameter) << ", sigma " << parameter.sigma;
    sum += z * z;
    ++count;
  }
  EXPECT_GT(count, 40);
  EXPECT_LT(std::sqrt(sum / count), 1.3);
}

struct Calibrated {
  test::SurveyedRoom room;
  RoomCalibration found;

  explicit Calibrated(const test::SurveyedRoomOptions& how)
      : room(test::make_surveyed_room(how)),
        found(calibrate_jointly(room.plan, room.points, options_of(room), {}).value()) {}
};

// As many points as a survey of such a room has.
const Calibrated& well_surveyed() {
  static const Calibrated kCalibrated({.points = 120});
  return kCalibrated;
}

TEST(JointCalibration, RecoversTheWalls) {
  const auto& [room, found] = well_surveyed();
  for (const char* wall : {"west.+x", "east.-x", "south.+y", "north.-y"}) {
    EXPECT_LT(std::abs(error_of(room, found, wall + std::string(".offset"))), 0.003) << wall;
  }
}

// Not the height of the array: all points have its height, and only floor and ceiling indicate it.
TEST(JointCalibration, RecoversTheArray) {
  const auto& [room, found] = well_surveyed();
  EXPECT_LT(std::abs(error_of(room, found, "a.position.x")), 0.002);
  EXPECT_LT(std::abs(error_of(room, found, "a.position.y")), 0.002);
  EXPECT_LT(std::abs(error_of(room, found, "a.yaw")), 0.2 * kDegree);
}

TEST(JointCalibration, RecoversTheChains) {
  const auto& [room, found] = well_surveyed();
  const RoomAccessPoint& truth = room.built.access_points[0];
  for (const std::size_t rx_chain : {1U, 2U}) {
    EXPECT_GT(std::abs(chain_phase(truth, rx_chain)), 5.0 * kDegree);
    EXPECT_NEAR(chain_phase(found.room.access_points[0], rx_chain),
                chain_phase(truth, rx_chain),
                3.0 * kDegree);
  }
  // The stated parameters are those that are written.
  int stated = 0;
  for (const RoomParameter& parameter : found.parameters) {
    if (parameter.unit == "deg") {
      const std::size_t rx_chain = parameter.id.of.find("core0/") != std::string::npos ? 1U : 2U;
      const double written = chain_phase(found.room.access_points[0], rx_chain) / kDegree;
      EXPECT_NEAR(std::remainder(parameter.value - written, 360.0), 0.0, 1e-9)
          << to_string(parameter.id);
      EXPECT_GT(parameter.prior_sigma, 0.0) << to_string(parameter.id);
      EXPECT_GT(parameter.sigma, 0.0) << to_string(parameter.id);
      ++stated;
    }
  }
  EXPECT_EQ(stated, 2);
}

TEST(JointCalibration, ExplainsPointsThatItHasNotSeen) {
  const auto& [room, found] = well_surveyed();
  EXPECT_LT(held_out_fit(room, found, &PointFit::before), 0.9);
  EXPECT_GT(held_out_fit(room, found, &PointFit::after), 0.97);
  // Survey errors are most of the rest.
  EXPECT_GT(held_out_fit(room, found, &PointFit::placed), 0.99);
}

// Walls of several centimetres, twice as far off: derivatives by their thickness mislead (a full
// step of the second round loses 0.14 of the correlation; without shorter ones 0.987 is reached).
TEST(JointCalibration, ShortensStepsWhereDerivativesMislead) {
  const Calibrated thick({.points = 80, .error = 2.0, .plasterboard = 0.033});
  EXPECT_LT(held_out_fit(thick.room, thick.found, &PointFit::before), 0.6);
  EXPECT_GT(held_out_fit(thick.room, thick.found, &PointFit::placed), 0.995);
}

TEST(JointCalibration, StatedUncertaintyIncludesTheTruth) {
  expect_honest(well_surveyed().room, well_surveyed().found);
}

// In the third room, two walls first settle half a wave off, and wave_cycles sets them right.
TEST(JointCalibration, StatedUncertaintyIncludesTheTruthInOtherRooms) {
  for (const unsigned seed : {2U, 3U}) {
    const Calibrated other({.seed = seed});
    expect_honest(other.room, other.found);
  }
}

TEST(JointCalibration, FitsAllAccessPointsTogether) {
  const Calibrated three({.points = 40, .access_points = 3, .trace = {.max_depth = 2}});
  for (const char* id : {"a", "b", "c"}) {
    EXPECT_LT(std::abs(error_of(three.room, three.found, id + std::string(".yaw"))), 0.3 * kDegree)
        << id;
  }
  EXPECT_GT(held_out_fit(three.room, three.found, &PointFit::after), 0.97);
}

// Without a stated accuracy. Errors of half a wavelength, like 3 cm, resemble others: the estimate
// is less.
TEST(JointCalibration, EstimatesTheSurveyError) {
  for (const double sigma : {0.004, 0.01, 0.03}) {
    const test::SurveyedRoom room = test::make_surveyed_room(
        {.points = 40, .furniture = 1, .survey = sigma, .trace = {.max_depth = 2}});
    JointCalibrationOptions options = options_of(room);
    options.finds_survey = true;
    const auto found = calibrate_jointly(room.plan, room.points, options, {}).value();
    double squares = 0.0;
    for (const Vec3d& error : room.survey_error) {
      squares += dot(error, error) / 3.0;
    }
    const double truth = std::sqrt(squares / static_cast<double>(room.survey_error.size()));
    EXPECT_GT(found.survey_sigma, sigma < 0.02 ? 0.7 * truth : 0.011) << sigma;
    EXPECT_LT(found.survey_sigma, 1.4 * truth) << sigma;
  }
}

// A small survey, for what does not need a good one.
const test::SurveyedRoom& small_survey() {
  static const test::SurveyedRoom kRoom =
      test::make_surveyed_room({.points = 30, .furniture = 1, .trace = {.max_depth = 2}});
  return kRoom;
}

JointCalibrationOptions quick() {
  JointCalibrationOptions options = options_of(small_survey());
  options.iterations = 4;
  return options;
}

// All results of a calibration, as numbers.
std::vector<double> numbers(const RoomCalibration& calibration) {
  std::vector<double> all;
  for (const RoomParameter& parameter : calibration.parameters) {
    all.insert(all.end(), {parameter.value, parameter.sigma});
  }
  for (const PointFit& fit : calibration.points) {
    all.insert(all.end(), {fit.before, fit.after, fit.placed});
  }
  for (const RoomAccessPoint& ap : calibration.room.access_points) {
    for (const std::complex<double>& gain : ap.gains.gain) {
      all.insert(all.end(), {gain.real(), gain.imag()});
    }
  }
  return all;
}

TEST(JointCalibration, DoesNotDependOnTheNumberOfThreads) {
  const auto on_threads = [](int threads) {
    const tbb::global_control at_least(tbb::global_control::max_allowed_parallelism, 4);
    tbb::task_arena arena(threads);
    std::vector<double> result;
    arena.execute([&] {
      result = numbers(
          calibrate_jointly(small_survey().plan, small_survey().points, quick(), {}).value());
    });
    return result;
  };
  const std::vector<double> one = on_threads(1);
  EXPECT_GT(one.size(), 100U);
  EXPECT_EQ(one, on_threads(2));
  EXPECT_EQ(one, on_threads(4));
}

TEST(JointCalibration, GoesOnFromEachCheckpointAsIfNeverInterrupted) {
  std::vector<JointCheckpoint> checkpoints;
  JointCalibrationOptions options = quick();
  options.on_checkpoint = [&](const JointCheckpoint& one) { checkpoints.push_back(one); };
  const auto whole =
      calibrate_jointly(small_survey().plan, small_survey().points, options, {}).value();
  ASSERT_EQ(checkpoints.size(), 5U);  // at the start, and after each round
  for (const JointCheckpoint& checkpoint : checkpoints) {
    JointCalibrationOptions from = quick();
    from.resume = &checkpoint;
    const auto resumed =
        calibrate_jointly(small_survey().plan, small_survey().points, from, {}).value();
    EXPECT_EQ(numbers(resumed), numbers(whole)) << checkpoint.rounds;
    ASSERT_EQ(resumed.history.size(), whole.history.size()) << checkpoint.rounds;
    for (std::size_t i = 0; i < whole.history.size(); ++i) {
      EXPECT_EQ(resumed.history[i].stage, whole.history[i].stage) << i;
      EXPECT_EQ(resumed.history[i].iteration, static_cast<int>(i));
      EXPECT_EQ(resumed.history[i].loss, whole.history[i].loss) << i;
      EXPECT_EQ(resumed.history[i].heldout, whole.history[i].heldout) << i;
    }
  }
}

// Progress that a user reads: it counts the fitted points, and its share neither exceeds 1 nor
// decreases.
TEST(JointCalibration, ReportsItsProgress) {
  double last = 0.0;
  const auto observe = [&](const CalibrationProgress& progress) {
    EXPECT_GE(progress.share, last);
    EXPECT_LE(progress.share, 1.0);
    EXPECT_EQ(progress.points, 24U);  // of 30, every fifth is held out
    last = progress.share;
    return true;
  };
  ASSERT_TRUE(calibrate_jointly(small_survey().plan, small_survey().points, quick(), observe));
  EXPECT_GT(last, 0.8);
}

TEST(JointCalibration, LeavesTheLastGoodStateWhenItIsStopped) {
  int steps = 0;
  const auto count = [&](const CalibrationProgress&) { return ++steps > 0; };
  ASSERT_FALSE(calibrate_jointly(small_survey().plan, small_survey().points, quick(), count)
                   .value()
                   .interrupted);
  for (const int stop_at : {1, 2, steps / 2, steps}) {
    std::optional<JointCheckpoint> good;
    JointCalibrationOptions options = quick();
    options.on_checkpoint = [&](const JointCheckpoint& one) { good = one; };
    int calls = 0;
    const auto stopped =
        calibrate_jointly(small_survey().plan,
                          small_survey().points,
                          options,
                          [&](const CalibrationProgress&) { return ++calls < stop_at; })
            .value();
    EXPECT_TRUE(stopped.interrupted) << stop_at;
    ASSERT_TRUE(good) << "one can go on from the first moment on";
    EXPECT_EQ(calls, stop_at);
    EXPECT_GE(held_out_fit(small_survey(), stopped, &PointFit::after),
              held_out_fit(small_survey(), stopped, &PointFit::before) - 1e-6)
        << stop_at;
    for (const RoomParameter& parameter : stopped.parameters) {
      if (good->rounds == 0 && parameter.id.quantity == Quantity::kSurfaceOffset) {
        EXPECT_EQ(parameter.value, 0.0) << to_string(parameter.id);  // as planned
      }
    }
    if (stop_at > steps / 4) {
      EXPECT_GT(good->rounds, 0) << stop_at;
      EXPECT_EQ(stopped.room.access_points[0].gains.gain, good->gains[0].gain) << stop_at;
    }
  }
}

TEST(JointCalibration, NamesAnAccessPointWithTooFewPoints) {
  test::SurveyedRoom room =
      test::make_surveyed_room({.points = 12, .access_points = 2, .trace = {.max_depth = 1}});
  for (std::size_t p = 3; p < room.points.size(); ++p) {
    room.points[p].h[1].clear();
  }
  const auto found = calibrate_jointly(room.plan, room.points, options_of(room), {});
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().message.find("access point b: "), std::string::npos)
      << found.error().message;
  EXPECT_NE(found.error().message.find("at least 4 are needed"), std::string::npos);
}

TEST(JointCalibration, RefusesASurveyWithoutFrames) {
  test::SurveyedRoom room = test::make_surveyed_room({.points = 6, .trace = {.max_depth = 1}});
  for (CalibrationPoint& point : room.points) {
    point.h[0].clear();
  }
  const auto found = calibrate_jointly(room.plan, room.points, options_of(room), {});
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().message.find("no access point received"), std::string::npos);
}

}  // namespace
}  // namespace rayloc::joint_calibration_test
