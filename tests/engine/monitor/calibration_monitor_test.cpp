#include "engine/monitor/calibration_monitor.h"

#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/constants.h"
#include "engine/observe/burst.h"
#include "engine/observe/chain_gains.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::calibration_monitor_test {
namespace {

using ::testing::HasSubstr;

const std::vector<Vec3d> kPlugs = {{1.2, -0.9, 0.6}, {-0.4, -1.0, 1.9}, {0.6, 0.9, 1.5}};

RoomModel calibrated() {
  RoomModel room = test::make_room();
  for (RoomAccessPoint& ap : room.access_points) {
    ap.error.plan_tolerance = 0.002;
  }
  return room;
}

// Bursts of the plugs in a room, received by its access points, for a monitor whose model is
// another room.
class Stream {
 public:
  explicit Stream(const RoomModel& assumed, std::vector<Vec3d> plugs = kPlugs)
      : monitor_(std::make_shared<const RoomModel>(assumed)),
        device_(assumed.device),
        plugs_(std::move(plugs)) {}

  // `turn` [rad] of core 3 of the first access point.
  void send(const RoomModel& room, int bursts, double turn = 0.0, double snr_db = 25.0) {
    for (int i = 0; i < bursts; ++i) {
      const Vec3d& plug = plugs_[seed_ % plugs_.size()];
      auto frames = test::frames_at(room, plug, {3, snr_db, ++seed_});
      for (CsiFrame& frame : frames) {
        if (frame.access_point == 0) {
          for (auto& value : frame.csi.row(2, 0)) {
            value *= std::complex<float>(std::polar(1.0, turn));
          }
        }
      }
      monitor_.observe({plug, device_}, frames);
    }
  }
  std::vector<CalibrationWarning> warnings() const { return monitor_.warnings(); }
  // Everything is sent again.
  void restart() {
    monitor_.restart();
    seed_ = 0;
  }
  // States the channels of the plugs in `room`.
  void set_reference(const RoomModel& room) {
    for (const Vec3d& plug : plugs_) {
      const auto frames = test::frames_at(room, plug, {8, 30.0, 99});
      for (std::size_t a = 0; a < room.access_points.size(); ++a) {
        const RoomAccessPoint& ap = room.access_points[a];
        auto h = combine_burst(frames, {a, room.grid, ap.rx_chains, {}}).value().h;
        remove_gains(ap.gains, h);
        monitor_.set_reference({plug, device_}, a, std::move(h));
      }
    }
  }

 private:
  CalibrationMonitor monitor_;
  DeviceModel device_;
  std::vector<Vec3d> plugs_;
  unsigned seed_ = 0;
};

TEST(CalibrationMonitor, GivesNoWarningInAHealthyRoom) {
  const RoomModel room = calibrated();
  Stream stream(room);
  for (int i = 0; i < 50; ++i) {
    stream.send(room, 1);
    ASSERT_TRUE(stream.warnings().empty()) << i << " " << stream.warnings()[0].text;
  }
}

TEST(CalibrationMonitor, NamesTheChainThatJumpedAndForgetsItAfterwards) {
  const RoomModel room = calibrated();
  Stream stream(room);
  stream.send(room, 15);
  stream.send(room, 15, std::numbers::pi / 2.0);
  auto warnings = stream.warnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].problem, CalibrationProblem::kChainPhaseJump);
  EXPECT_EQ(warnings[0].access_point, 0U);
  EXPECT_EQ(warnings[0].rx_chain, 3);
  EXPECT_NEAR(warnings[0].phase, std::numbers::pi / 2.0, 5.0 * kDegree);
  EXPECT_THAT(warnings[0].text, HasSubstr("chain_phase_jump: access point a, core 3"));
  stream.send(room, 100);
  EXPECT_TRUE(stream.warnings().empty());
}

TEST(CalibrationMonitor, BeginsAnewWhenItIsMovedToAnotherTime) {
  constexpr double kTurn = std::numbers::pi / 2.0;
  const RoomModel room = calibrated();
  Stream moved(room);
  moved.send(room, 15);
  moved.send(room, 19, kTurn);  // and a window that has begun
  ASSERT_EQ(moved.warnings().size(), 1U);
  moved.restart();
  EXPECT_TRUE(moved.warnings().empty()) << "of another time";
  Stream fresh(room);
  for (Stream* stream : {&moved, &fresh}) {
    stream->send(room, 15, kTurn);
    ASSERT_EQ(stream->warnings().size(), 1U);
  }
  EXPECT_EQ(moved.warnings()[0].text, fresh.warnings()[0].text);
  EXPECT_EQ(moved.warnings()[0].fit, fresh.warnings()[0].fit);
  EXPECT_EQ(moved.warnings()[0].usual_fit, fresh.warnings()[0].usual_fit);
}

TEST(CalibrationMonitor, SeesAJumpThatWasThereBeforeItStarted) {
  const RoomModel room = calibrated();
  Stream stream(room);
  stream.send(room, 15, std::numbers::pi);
  ASSERT_EQ(stream.warnings().size(), 1U);
  EXPECT_NEAR(std::abs(stream.warnings()[0].phase), std::numbers::pi, 5.0 * kDegree);
}

// A plan with errors of centimetres predicts little but the direct path: the other paths turn the
// chains by far more than an eighth of a turn, at most places of a plug.
TEST(CalibrationMonitor, GivesNoWarningForPhasesThePlanCannotPredict) {
  const RoomModel room = calibrated();
  RoomModel plan = room;
  for (RoomAccessPoint& ap : plan.access_points) {
    ap.error.plan_tolerance = 0.03;
  }
  for (const double x : {-1.2, -0.6, 0.0, 0.6, 1.2}) {
    for (const double y : {-0.9, -0.3, 0.3, 0.9}) {
      Stream stream(plan, {{x, y, 1.1}});
      stream.send(room, 15);
      EXPECT_TRUE(stream.warnings().empty()) << x << " " << y << " " << stream.warnings()[0].text;
      stream.send(room, 15, std::numbers::pi / 2.0);
      ASSERT_FALSE(stream.warnings().empty()) << x << " " << y;
      EXPECT_THAT(stream.warnings()[0].text, HasSubstr("chain_phase_jump: access point a, core 3"));
    }
  }
}

TEST(CalibrationMonitor, DetectsAnEarlierJumpFromTheReference) {
  const RoomModel room = calibrated();
  RoomModel plan = room;
  for (RoomAccessPoint& ap : plan.access_points) {
    ap.error.plan_tolerance = 0.03;
  }
  Stream healthy(plan, {{-0.6, 0.9, 1.1}});
  healthy.set_reference(room);
  healthy.send(room, 15);
  EXPECT_TRUE(healthy.warnings().empty()) << healthy.warnings()[0].text;
  Stream jumped(plan, {{-0.6, 0.9, 1.1}});
  jumped.set_reference(room);
  jumped.send(room, 15, std::numbers::pi / 2.0);
  ASSERT_EQ(jumped.warnings().size(), 1U);
  EXPECT_EQ(jumped.warnings()[0].rx_chain, 3);
  EXPECT_NEAR(jumped.warnings()[0].phase, std::numbers::pi / 2.0, 5.0 * kDegree);
}

TEST(CalibrationMonitor, StatesHowAnAccessPointHasMoved) {
  const RoomModel room = calibrated();
  RoomModel kicked = room;
  Pose& pose = kicked.access_points[1].array.pose;
  pose.position = pose.position + Vec3d{-0.02, 0.03, 0.0};
  pose.orientation.yaw += 4.0 * kDegree;
  Stream stream(room);
  stream.send(room, 15);
  stream.send(kicked, 20);
  const auto warnings = stream.warnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].problem, CalibrationProblem::kAccessPointMoved) << warnings[0].text;
  EXPECT_EQ(warnings[0].access_point, 1U);
  EXPECT_NEAR(warnings[0].motion.shift.x, -0.02, 0.01);
  EXPECT_NEAR(warnings[0].motion.shift.y, 0.03, 0.01);
  EXPECT_NEAR(warnings[0].motion.yaw, 4.0 * kDegree, 1.0 * kDegree);
  EXPECT_THAT(warnings[0].text, HasSubstr("3 cm in y"));
}

TEST(CalibrationMonitor, WarnsWhenTheRoomExplainsLessThanItDid) {
  const RoomModel room = calibrated();
  Stream stream(room);
  stream.send(room, 15);
  stream.send(room, 5, 0.0, -5.0);  // one spoilt window is no drift
  EXPECT_TRUE(stream.warnings().empty());
  stream.send(room, 100, 0.0, 0.0);
  const auto warnings = stream.warnings();
  ASSERT_EQ(warnings.size(), 3U);
  EXPECT_EQ(warnings[0].problem, CalibrationProblem::kResidualDrift);
  EXPECT_THAT(warnings[0].text, HasSubstr("residual_drift: access point a"));
}

}  // namespace
}  // namespace rayloc::calibration_monitor_test
