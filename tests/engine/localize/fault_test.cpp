// Fixes under a fault that no fixed transmitter has indicated yet: no fix, a wider region, or a
// warning that names the access point; never a small region at a wrong place.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "engine/calibrate/access_point_fit.h"
#include "engine/localize/localizer.h"
#include "tests/support/faulty_frames.h"
#include "tests/support/surveyed_room.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::fault_test {
namespace {

using Frames = std::vector<CsiFrame>;

constexpr int kPoints = 48;  // surveyed; as many others are located
constexpr std::size_t kCases = 48;
constexpr double kWrong = 0.05;  // share of the regions of 95 % that may exclude the truth

// A calibrated room: walls 2 to 3 mm off, arrays a millimetre and a quarter of a degree, the chains
// and the errors of the model fitted to surveyed points.
struct Calibrated {
  RoomModel room;
  std::vector<CalibrationPoint> points;  // places of the device, and their channels
};

Calibrated calibrate() {
  test::SurveyedRoomOptions options{.points = kPoints, .access_points = 3, .error = 0.25};
  const test::SurveyedRoom survey = test::make_surveyed_room(options);
  Calibrated result{survey.plan, {}};
  for (std::size_t a = 0; a < survey.plan.access_points.size(); ++a) {
    std::vector<CalibrationSample> samples;
    for (const CalibrationPoint& point : survey.points) {
      samples.push_back({point.position, point.h[a]});
    }
    const AccessPointCalibrator calibrator(survey.plan, a, std::move(samples));
    const AccessPointFit fit = calibrator.fit().value();
    RoomAccessPoint& ap = result.room.access_points[a];
    ap.array.pose.orientation.yaw += fit.yaw_offset.value;
    ap.error = fit.error.value();
    ap.gains = fit.gains;
  }
  // frames_of() puts its own gains on top.
  for (std::size_t a = 0; a < result.room.access_points.size(); ++a) {
    ChainGains& gains = result.room.access_points[a].gains;
    const ChainGains more = test::make_gains(result.room, a);
    for (std::size_t j = 0; j < gains.gain.size(); ++j) {
      gains.gain[j] *= more.gain[j];
    }
  }
  options.seed = 2;
  options.survey = 0.0;
  result.points = test::make_surveyed_room(options).points;
  return result;
}

const Calibrated& calibrated() {
  static const Calibrated kCalibrated = calibrate();
  return kCalibrated;
}

std::shared_ptr<const RoomModel> room_of(std::size_t access_points) {
  RoomModel room = calibrated().room;
  room.access_points.resize(access_points);
  return std::make_shared<const RoomModel>(std::move(room));
}

const Localizer& localizer(std::size_t access_points) {
  static const Localizer kOne = *Localizer::create(room_of(1), {});
  static const Localizer kTwo = *Localizer::create(room_of(2), {});
  static const Localizer kThree = *Localizer::create(room_of(3), {});
  return access_points == 1 ? kOne : access_points == 2 ? kTwo : kThree;
}

Frames frames_at(const RoomModel& room, std::size_t point) {
  auto channels = calibrated().points[point].h;
  channels.resize(room.access_points.size());
  return test::frames_of(room, channels, {10, 30.0, static_cast<unsigned>(point + 1)});
}

struct Tally {
  std::size_t cases = 0;
  std::size_t no_fix = 0;
  std::size_t named = 0;  // fixes with the access point that is wrong in a warning
  std::size_t wrong = 0;  // regions of 95 % that exclude the truth

  Tally& operator+=(const Tally& other) {
    cases += other.cases;
    no_fix += other.no_fix;
    named += other.named;
    wrong += other.wrong;
    return *this;
  }
};

// Does it to the frames; returns what a warning that names it has in it.
using Spoil = std::function<std::string(std::size_t point, Frames& frames)>;
Tally study(const std::string& name, const Localizer& by, const Spoil& spoil) {
  Tally tally;
  for (std::size_t point = 0; point < kCases; ++point) {
    Frames frames = frames_at(by.room(), point);
    const std::string culprit = spoil(point, frames);
    const LocationEstimate estimate = by.locate(frames);
    ++tally.cases;
    if (!estimate.position) {
      EXPECT_FALSE(estimate.reason.empty());
      ++tally.no_fix;
      continue;
    }
    const Vec3d& truth = calibrated().points[point].position;
    const double error = std::hypot(estimate.position->x - truth.x, estimate.position->y - truth.y);
    // The residual probability may be anywhere: then the region of 95 % is everything.
    tally.wrong += error > estimate.accuracy_m && estimate.residual_probability < 0.05 ? 1U : 0U;
    bool named = false;
    for (const std::string& warning : estimate.warnings) {
      named = named || (!culprit.empty() && warning.find(culprit) != std::string::npos);
    }
    tally.named += named ? 1U : 0U;
  }
  std::printf("%s, %zu access points: n %zu, no fix %zu, named %zu, wrong %zu\n",
              name.c_str(),
              by.room().access_points.size(),
              tally.cases,
              tally.no_fix,
              tally.named,
              tally.wrong);
  return tally;
}

// Checks the cases of one fault, with any number of access points.
void expect_honest(const Tally& tally) {
  EXPECT_LE(static_cast<double>(tally.wrong), kWrong * static_cast<double>(tally.cases));
}

// The access point with the fault, one after the other.
std::size_t hit(const Localizer& by, std::size_t point) {
  return point % by.room().access_points.size();
}
std::string name_of(const Localizer& by, std::size_t point) {
  return "access point " + by.room().access_points[hit(by, point)].id;
}
std::uint8_t rx_chain_of(const Localizer& by, std::size_t point) {
  const auto& rx_chains = by.room().access_points[hit(by, point)].rx_chains;
  return rx_chains[(point / by.room().access_points.size()) % rx_chains.size()];
}

TEST(Fault, NoFaultCausesNoAlarm) {
  Tally all;
  for (const std::size_t access_points : {1U, 2U, 3U}) {
    const Localizer& by = localizer(access_points);
    const Tally tally = study(
        "nothing wrong", by, [&](std::size_t, Frames&) { return std::string("access point"); });
    EXPECT_EQ(tally.no_fix, 0U);
    EXPECT_LE(tally.named, 2U);
    all += tally;
  }
  expect_honest(all);
}

TEST(Fault, DeadChainIsNamedAndLeftOut) {
  Tally all;
  for (const std::size_t access_points : {1U, 3U}) {
    const Localizer& by = localizer(access_points);
    std::mt19937 random(3);
    const Tally tally = study("chain dead", by, [&](std::size_t point, Frames& frames) {
      test::kill_chain(frames, hit(by, point), rx_chain_of(by, point), random);
      return name_of(by, point) + ": the chain of core " + std::to_string(rx_chain_of(by, point)) +
             " is dead";
    });
    EXPECT_EQ(tally.named + tally.no_fix, tally.cases);
    EXPECT_LE(tally.no_fix, 2U);
    all += tally;
  }
  expect_honest(all);
}

// The noise of a burst that is weaker than those that the room was calibrated by.
TEST(Fault, WeakDevice) {
  Tally all;
  for (const std::size_t access_points : {1U, 3U}) {
    const Localizer& by = localizer(access_points);
    for (const double snr_db : {20.0, 10.0, 3.0}) {
      const Tally tally =
          study("frames of " + std::to_string(std::lround(snr_db)) + " dB",
                by,
                [&](std::size_t point, Frames& frames) {
                  auto channels = calibrated().points[point].h;
                  channels.resize(by.room().access_points.size());
                  frames = test::frames_of(
                      by.room(), channels, {10, snr_db, static_cast<unsigned>(point + 1)});
                  return std::string();
                });
      EXPECT_LE(tally.no_fix, 2U);
      all += tally;
    }
  }
  expect_honest(all);
}

// Chips start in states a quarter turn apart.
TEST(Fault, JumpedPhaseOfAChain) {
  Tally all;
  for (const std::size_t access_points : {1U, 2U, 3U}) {
    const Localizer& by = localizer(access_points);
    const Tally tally = study("chain's phase jumped", by, [&](std::size_t point, Frames& frames) {
      test::turn_chain(frames,
                       hit(by, point),
                       rx_chain_of(by, point),
                       0.5 * std::numbers::pi * static_cast<double>(1 + point % 3));
      return name_of(by, point);
    });
    all += tally;
  }
  expect_honest(all);
}

// Its reflections locate the device; with other access points, at least half of the cases name it.
TEST(Fault, ObstructedAccessPoint) {
  Tally all;
  for (const std::size_t access_points : {1U, 2U, 3U}) {
    const Localizer& by = localizer(access_points);
    const Tally tally = study("access point covered", by, [&](std::size_t point, Frames& frames) {
      test::obstruct(frames, hit(by, point), by.room(), calibrated().points[point].position);
      return name_of(by, point);
    });
    if (access_points > 1) {
      EXPECT_GE(tally.named, tally.cases / 2);
    }
    EXPECT_LE(tally.no_fix, 2U);
    all += tally;
  }
  expect_honest(all);
}

TEST(Fault, ChannelOfAnotherRoom) {
  Tally all;
  for (const std::size_t access_points : {1U, 2U, 3U}) {
    const Localizer& by = localizer(access_points);
    std::mt19937 random(5);
    std::vector<double> offset_hz;
    for (std::size_t k = 0; k < by.room().grid.size(); ++k) {
      offset_hz.push_back(by.room().grid.offset_hz(k));
    }
    const Tally tally = study("another room's channel", by, [&](std::size_t point, Frames& frames) {
      std::vector<std::vector<std::complex<double>>> channels;
      for (std::size_t a = 0; a < by.room().access_points.size(); ++a) {
        channels.push_back(test::strange_channel(3, offset_hz, random));
      }
      frames = test::frames_of(by.room(), channels, {10, 30.0, static_cast<unsigned>(point + 1)});
      return std::string();
    });
    all += tally;
  }
  expect_honest(all);
}

TEST(Fault, AbsentTransmitterLeavesNoise) {
  for (const std::size_t access_points : {1U, 3U}) {
    const Localizer& by = localizer(access_points);
    const Tally tally = study("noise alone", by, [&](std::size_t point, Frames& frames) {
      auto channels = calibrated().points[point].h;
      channels.resize(by.room().access_points.size());
      frames = test::frames_of(by.room(), channels, {10, -40.0, static_cast<unsigned>(point + 1)});
      return std::string();
    });
    EXPECT_EQ(tally.no_fix, tally.cases);
  }
}

// The map ends 0.3 m before the device or more.
TEST(Fault, DeviceOutsideOfTheArea) {
  Tally tally;
  for (const bool upper : {false, true}) {
    RoomModel half = *room_of(3);
    (upper ? half.bounds_min.x : half.bounds_max.x) = 0.0;
    const Localizer by = *Localizer::create(std::make_shared<const RoomModel>(half), {});
    for (std::size_t point = 0; point < kCases; ++point) {
      const double x = calibrated().points[point].position.x;
      if (upper ? x > -0.3 : x < 0.3) {
        continue;
      }
      const LocationEstimate estimate = by.locate(frames_at(half, point));
      ++tally.cases;
      tally.no_fix += estimate.position ? 0U : 1U;
      tally.wrong += estimate.position && estimate.residual_probability < 0.05 ? 1U : 0U;
    }
  }
  std::printf("outside of the area, 3 access points: n %zu, no fix %zu, wrong %zu\n",
              tally.cases,
              tally.no_fix,
              tally.wrong);
  ASSERT_GE(tally.cases, 20U);
  expect_honest(tally);
}

}  // namespace
}  // namespace rayloc::fault_test
