#include "daemon/lab/calibrate/power_offset_stage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "engine/likelihood/received_power.h"
#include "engine/room/ray.h"
#include "engine/trace/path_tracer.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::power_offset_stage_test {
namespace {

const MacAddress kDevice = *parse_mac_address("02:52:4c:00:00:01");
const MacAddress kPhone = *parse_mac_address("02:52:4c:00:00:02");
constexpr std::size_t kReceivedBy = 2;
constexpr double kDiffuse = 0.4;  // as fitted, not as the room has it

// Every point has the power that is traced there, 30 dB lower, and every second one is 2 dB above
// that, the others 2 dB below.
class PowerOffsetStage : public ::testing::Test {
 protected:
  PowerOffsetStage() {
    result_.index = kReceivedBy;
    result_.fit.gains = room_.access_points[kReceivedBy].gains;
    result_.fit.error.diffuse.value = kDiffuse;
    const RoomAccessPoint& ap = room_.access_points[kReceivedBy];
    const ReceiverTracer tracer = PathTracer(room_.scene, room_.trace)
                                      .at(Receiver{{ap.array.pose.position,
                                                    ap.array.pose.orientation,
                                                    ap.array.pattern,
                                                    ap.array.polarization}});
    ModelError error;
    error.diffuse = kDiffuse;
    std::mt19937 random(2);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int i = 0; i < 12; ++i) {
      const double x = 1.1 * uniform(random);
      const Vec3d place{x, 0.7 * uniform(random), 1.2};
      const Transmitter device{{place, {}, room_.device.pattern, room_.device.polarization}};
      const auto rays = rays_of(tracer.trace(device), room_, place, 64);
      const double power = traced_power_db(rays, error) - 30.0 + (i % 2 == 0 ? 2.0 : -2.0);
      places_.push_back(place);
      frames_.push_back(test::frames_at(room_, place, {2, 30.0, static_cast<unsigned>(i + 1)}));
      for (CsiFrame& frame : frames_.back()) {
        frame.transmitter = kDevice;
        const bool there = frame.access_point == static_cast<int>(kReceivedBy);
        frame.power_dbm.assign(frame.rx_chains.size(), there ? static_cast<float>(power) : -5.0F);
      }
    }
    site_.transmitters.resize(2);
    site_.transmitters[0].mac = kPhone;
    site_.transmitters[1].mac = kDevice;
    site_.transmitters[1].constant_power = true;
  }

  std::vector<TransmitterPower> fit(std::size_t points = 12) {
    std::vector<HeldOutPoint> received;
    for (std::size_t i = 0; i < points; ++i) {
      received.push_back({places_[i], frames_[i]});
    }
    return fit_power_offsets(site_, room_, result_, received, refused_);
  }

  RoomModel room_ = test::make_room();
  AccessPointResult result_;
  Site site_;
  std::vector<Vec3d> places_;
  std::vector<std::vector<CsiFrame>> frames_;
  std::vector<RefusedInput> refused_;
};

TEST_F(PowerOffsetStage, FitsTheTransmittersOfConstantPower) {
  const auto powers = fit();
  ASSERT_EQ(powers.size(), 1U);
  EXPECT_EQ(powers[0].transmitter, kDevice);
  EXPECT_NEAR(powers[0].offset_db, -30.0, 1e-4);
  EXPECT_NEAR(powers[0].sigma_db, 2.0 * std::sqrt(12.0 / 11.0), 1e-4);
  EXPECT_TRUE(refused_.empty());
}

TEST_F(PowerOffsetStage, FitsNothingWhereNoPowerIsConstant) {
  site_.transmitters[1].constant_power = false;
  EXPECT_TRUE(fit().empty());
  EXPECT_TRUE(refused_.empty());
}

TEST_F(PowerOffsetStage, RefusesTooFewPointsForAPathLossLaw) {
  EXPECT_TRUE(fit(9).empty());
  ASSERT_EQ(refused_.size(), 1U);
  EXPECT_EQ(refused_[0].what, "c 02:52:4c:00:00:01");
  EXPECT_EQ(refused_[0].reason,
            "its constant power is not used: 9 points state a level, 10 are needed");
}

TEST_F(PowerOffsetStage, CountsNeitherFramesOfOthersNorThoseWithoutAPower) {
  for (CsiFrame& frame : frames_[0]) {
    frame.transmitter = kPhone;
  }
  EXPECT_EQ(fit().size(), 1U);  // eleven
  for (const std::size_t silent : {1U, 2U}) {
    for (CsiFrame& frame : frames_[silent]) {
      frame.power_dbm.clear();
    }
  }
  EXPECT_TRUE(fit().empty());
  ASSERT_EQ(refused_.size(), 1U);
  EXPECT_NE(refused_[0].reason.find("9 points"), std::string::npos) << refused_[0].reason;
}

}  // namespace
}  // namespace rayloc::power_offset_stage_test
