#include "engine/baselines/spotfi/spotfi.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/baselines/settings.h"
#include "engine/posterior/credible_region.h"
#include "tests/support/faulty_frames.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::spotfi_test {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const MacAddress kDevice = *parse_mac_address("02:00:00:00:00:01");

std::shared_ptr<const RoomModel> room_of(std::size_t access_points) {
  RoomModel room = test::make_room();
  room.access_points.resize(access_points);
  return std::make_shared<const RoomModel>(std::move(room));
}

// Frames of a device in the open air at all access points, with the power of a path-loss law.
std::vector<CsiFrame> in_sight(const RoomModel& room,
                               const Vec3d& place,
                               double snr_db,
                               unsigned seed = 1) {
  std::vector<std::vector<std::complex<double>>> channels;
  for (const RoomAccessPoint& ap : room.access_points) {
    auto& h = channels.emplace_back();
    for (std::size_t m = 0; m < ap.rx_chains.size(); ++m) {
      const double distance = norm(place - element_position(ap.array, m));
      for (std::size_t k = 0; k < room.grid.size(); ++k) {
        h.push_back(std::polar(
            1.0 / distance,
            -2.0 * std::numbers::pi * room.grid.frequency_hz(k) * distance / 299'792'458.0));
      }
    }
  }
  auto frames = test::frames_of(room, channels, {.count = 4, .snr_db = snr_db, .seed = seed});
  for (CsiFrame& frame : frames) {
    const auto& ap = room.access_points[frame.access_point];
    const double distance = norm(place - ap.array.pose.position);
    frame.transmitter = kDevice;
    frame.power_dbm.assign(ap.rx_chains.size(),
                           static_cast<float>(-30.0 - 20.0 * std::log10(distance)));
  }
  return frames;
}

std::shared_ptr<const Training> trained(const RoomModel& room) {
  auto training = std::make_shared<Training>();
  training->constant_power = {kDevice};
  for (const RoomAccessPoint& ap : room.access_points) {
    training->access_points.push_back({ap.id, 10, 0.05, 0.01, PathLossLaw{-30.0, 2.0, 0.5}});
  }
  return training;
}

double error_of(const LocationEstimate& estimate, const Vec3d& truth) {
  return std::hypot(estimate.position->x - truth.x, estimate.position->y - truth.y);
}

TEST(Spotfi, FindsADeviceInSightOfThreeAccessPoints) {
  const auto room = room_of(3);
  const auto spotfi = Spotfi::create(room, {}, trained(*room));
  ASSERT_TRUE(spotfi);
  for (const Vec3d truth : {Vec3d{0.3, 0.2, 1.2}, Vec3d{-0.7, -0.4, 1.2}, Vec3d{0.9, -0.5, 1.2}}) {
    const auto estimate = spotfi->locate(in_sight(*room, truth, 80.0));
    ASSERT_TRUE(estimate.position) << estimate.reason;
    EXPECT_LT(error_of(estimate, truth), 0.05);
    EXPECT_TRUE(estimate.is_uncertainty_stated);
    EXPECT_EQ(estimate.access_points_used, 3U);
    EXPECT_EQ(estimate.antennas_used, 9U);
    EXPECT_EQ(estimate.position->z, room->device.height);
  }
}

TEST(Spotfi, HasOneBearingAndAPowerWithOneAccessPoint) {
  const auto room = room_of(1);
  const Vec3d truth{0.3, 0.2, 1.2};
  const auto spotfi = Spotfi::create(room, {}, trained(*room));
  const auto estimate = spotfi->locate(in_sight(*room, truth, 60.0));
  ASSERT_TRUE(estimate.position) << estimate.reason;
  // Aliases of the bearing at that distance: one of the hypotheses is the place.
  EXPECT_TRUE(std::any_of(
      estimate.hypotheses.begin(), estimate.hypotheses.end(), [&](const Hypothesis& one) {
        return std::hypot(one.position.x - truth.x, one.position.y - truth.y) < 0.15;
      }));
}

TEST(Spotfi, RefusesOneBearingWithoutARange) {
  const auto room = room_of(1);
  const auto frames = in_sight(*room, {0.3, 0.2, 1.2}, 60.0);
  const auto refused = Spotfi::create(room, {}, nullptr)->locate(frames);
  EXPECT_FALSE(refused.position);
  EXPECT_EQ(refused.reason,
            "one access point and no learned level: spotfi has a bearing and no range (add access "
            "points; or declare constant_power, calibrate and train; or --baseline range=room)");
  SpotfiOptions options;
  options.range = SpotfiRange::kNone;
  EXPECT_FALSE(Spotfi::create(room, options, trained(*room))->locate(frames).position);
  options.range = SpotfiRange::kRoom;
  const auto clipped = Spotfi::create(room, options, nullptr)->locate(frames);
  ASSERT_TRUE(clipped.position);
  EXPECT_THAT(clipped.warnings,
              Contains("one bearing and no range: it ends at the walls of the room"));
}

// 200 places, one access point, no range: a region of 50 % holds half of them.
TEST(Spotfi, StatesHonestRegionsOfOneBearing) {
  const auto room = room_of(1);
  SpotfiOptions options;
  options.range = SpotfiRange::kRoom;
  options.path.frames = 1;
  auto training = std::make_shared<Training>();
  training->access_points.push_back({room->access_points[0].id, 10, 0.05, 0.01, std::nullopt});
  const auto spotfi = Spotfi::create(room, options, training);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int inside = 0;
  for (unsigned i = 0; i < 200; ++i) {
    const double y = uniform(random);
    const Vec3d truth{1.4 * uniform(random), 1.1 * y, 1.2};
    const auto estimate = spotfi->locate(in_sight(*room, truth, 40.0, i));
    ASSERT_TRUE(estimate.position);
    inside += region_reaching(estimate, truth).value_or(1.0) <= 0.5 ? 1 : 0;
  }
  EXPECT_GE(inside, 85);
  EXPECT_LE(inside, 125);
}

TEST(Spotfi, TakesAnUnknownPowerOut) {
  const auto room = room_of(3);
  const Vec3d truth{0.3, 0.2, 1.2};
  auto frames = in_sight(*room, truth, 60.0);
  const auto training = trained(*room);
  auto unknown = std::make_shared<Training>(*training);
  unknown->constant_power.clear();
  const auto spotfi = Spotfi::create(room, {}, unknown);
  const auto before = spotfi->locate(frames);
  for (CsiFrame& frame : frames) {
    for (auto& power : frame.power_dbm) {
      *power -= 17.0F;
    }
  }
  const auto after = spotfi->locate(frames);
  ASSERT_TRUE(before.position && after.position);
  EXPECT_NEAR(after.position->x, before.position->x, 1e-6);
  EXPECT_NEAR(after.position->y, before.position->y, 1e-6);
  EXPECT_LT(error_of(after, truth), 0.1);
}

TEST(Spotfi, ReportsTheReasonForNoFix) {
  const auto room = room_of(2);
  const auto spotfi = Spotfi::create(room, {}, nullptr);
  EXPECT_EQ(spotfi->locate({}).reason, "no frames");
  RoomModel uncalibrated = *room;
  for (RoomAccessPoint& ap : uncalibrated.access_points) {
    ap.gains = {};
  }
  const auto bare = std::make_shared<const RoomModel>(uncalibrated);
  const auto frames = in_sight(*room, {0.3, 0.2, 1.2}, 40.0);
  EXPECT_EQ(Spotfi::create(bare, {}, nullptr)->locate(frames).reason,
            "no chain gains, calibrate the site");
  RoomModel single = *room;
  single.access_points.resize(1);
  RoomAccessPoint& ap = single.access_points[0];
  ap.array.element_offset.resize(1);
  ap.rx_chains.resize(1);
  ap.gains.rx_chains.resize(1);
  ap.gains.gain.resize(single.grid.size());
  EXPECT_THAT(
      Spotfi::create(std::make_shared<const RoomModel>(single), {}, nullptr)->locate(frames).reason,
      HasSubstr("a has 1 usable antenna: a bearing needs 2"));
  RoomModel bent = *room;
  bent.access_points.resize(1);
  bent.access_points[0].array.element_offset[2].y += 0.02;
  EXPECT_THAT(
      Spotfi::create(std::make_shared<const RoomModel>(bent), {}, nullptr)->locate(frames).reason,
      HasSubstr("a: its antennas are not a line of equal steps along its y: no bearing"));
  RoomModel odd = *room;
  odd.grid.tone_index = {1, 2, 3, 5, 8};
  const auto no_comb = Spotfi::create(std::make_shared<const RoomModel>(odd), {}, nullptr);
  ASSERT_FALSE(no_comb);
  EXPECT_THAT(no_comb.error().message, StartsWith("spotfi needs tones in equal steps"));
}

TEST(Spotfi, LivesWithADeadChainAndASingleFrame) {
  const auto room = room_of(3);
  const Vec3d truth{0.3, 0.2, 1.2};
  auto frames = in_sight(*room, truth, 50.0);
  std::mt19937 random(1);
  test::kill_chain(frames, 0, 0, random);
  const auto spotfi = Spotfi::create(room, {}, trained(*room));
  const auto estimate = spotfi->locate(frames);
  ASSERT_TRUE(estimate.position);
  EXPECT_LT(error_of(estimate, truth), 0.15);
  EXPECT_TRUE(spotfi->locate(std::span(frames).subspan(4, 1)).position) << "of one frame";
}

TEST(Spotfi, IsTheSameWithOneThread) {
  const auto room = room_of(3);
  const auto frames = in_sight(*room, {0.3, 0.2, 1.2}, 30.0);
  const auto spotfi = Spotfi::create(room, {}, trained(*room));
  const auto many = spotfi->locate(frames);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto single = spotfi->locate(frames);
  EXPECT_EQ(many.position, single.position);
  EXPECT_EQ(many.covariance, single.covariance);
}

TEST(Spotfi, LearnsItsNumbersFromASurvey) {
  const auto room = room_of(2);
  TrainingInput input;
  input.room = room;
  input.constant_power = {kDevice};
  for (int x = -3; x <= 3; ++x) {
    for (int y = -2; y <= 2; ++y) {
      const Vec3d place{0.35 * x, 0.4 * y, 1.2};
      input.points.push_back({place, in_sight(*room, place, 40.0)});
    }
  }
  double share = 0.0;
  input.progress = [&](const TrainingProgress& progress) { share = progress.share; };
  const auto learned = train_spotfi(input);
  ASSERT_TRUE(learned);
  EXPECT_EQ(share, 1.0);
  EXPECT_EQ((*learned)->method, "spotfi");
  ASSERT_EQ((*learned)->access_points.size(), 2U);
  for (const AccessPointTraining& ap : (*learned)->access_points) {
    EXPECT_EQ(ap.points, 35U);
    EXPECT_LT(ap.sigma_psi, 0.15) << "in sight there is nothing but the direct path";
    ASSERT_TRUE(ap.path_loss);
    EXPECT_NEAR(ap.path_loss->exponent, 2.0, 0.02);
    EXPECT_NEAR(ap.path_loss->at_1m_dbm, -30.0, 0.1);
  }
  input.constant_power.clear();
  EXPECT_FALSE((*train_spotfi(input))->access_points[0].path_loss)
      << "of a power that may change nothing is learned";
  input.points.clear();
  EXPECT_EQ(train_spotfi(input).error().message, "no access point of the site received the survey");
}

TEST(BaselineSettings, AreReadAndRefusedByName) {
  BaselineValues values;
  const auto read = [&](const char* text) {
    return read_baseline_value(text, "spotfi", spotfi_settings(), values);
  };
  ASSERT_TRUE(read("grid_m=0.1"));
  ASSERT_TRUE(read("rank=mdl"));
  ASSERT_TRUE(read("range=room"));
  const SpotfiOptions options = spotfi_options(values);
  EXPECT_EQ(options.grid, 0.1);
  EXPECT_EQ(options.path.count, PathCountRule::kMdl);
  EXPECT_EQ(options.range, SpotfiRange::kRoom);
  EXPECT_EQ(options.path.frames, 10U);
  EXPECT_EQ(read("gird_m=5").error().message,
            "gird_m=5: no such setting of spotfi; did you mean 'grid_m'?");
  EXPECT_EQ(read("grid_m=5").error().message, "grid_m=5: 'grid_m' is a number from 0.01 to 1");
  EXPECT_EQ(read("frames=1.5").error().message,
            "frames=1.5: 'frames' is a whole number from 1 to 64");
  EXPECT_EQ(read("range=far").error().message, "range=far: 'range' is level, none or room");
  EXPECT_EQ(read("range").error().message, "range: write KEY=VALUE");
  const std::string help = baseline_settings_help(spotfi_settings());
  for (const BaselineSetting& setting : spotfi_settings()) {
    EXPECT_THAT(help, HasSubstr(std::string(setting.key) + "="));
  }
}

}  // namespace
}  // namespace rayloc::spotfi_test
