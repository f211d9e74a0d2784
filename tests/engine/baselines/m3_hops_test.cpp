// From frames of a device that hops over radio channels to a place.
#include "engine/baselines/m3/m3_hops.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdint>
#include <iterator>
#include <memory>
#include <numbers>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/median.h"
#include "engine/baselines/m3/m3.h"
#include "engine/baselines/paths/living_line.h"
#include "engine/observe/chain_gains.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::m3_hops_test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr Vec3d kPlace{0.3, 0.2, 1.2};
// Offsets of channels of 40 MHz from the site's channel [Hz].
const std::vector<double> kHops = {0.0, 40e6, 80e6, 120e6};

RoomModel on_channel(const RoomModel& room, double away_hz) {
  RoomModel other = room;
  other.grid.centre_hz += away_hz;
  return other;
}

RadioChannel channel_of(const RoomModel& room) { return {room.grid.centre_hz, 40}; }

void append(std::vector<CsiFrame> more, const RoomModel& room, std::vector<CsiFrame>& frames) {
  const Duration begin = frames.empty() ? Duration{} : std::chrono::milliseconds(100);
  const Timestamp after = frames.empty() ? Timestamp{} : frames.back().time;
  std::stable_sort(
      more.begin(), more.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  for (CsiFrame& frame : more) {
    frame.time = after + begin + frame.time.time_since_epoch();
    frame.channel = channel_of(room);
    frames.push_back(std::move(frame));
  }
}

std::vector<CsiFrame> frames_on(const RoomModel& room, std::span<const double> hops) {
  std::vector<CsiFrame> frames;
  unsigned seed = 1;
  for (const double away : hops) {
    const RoomModel other = on_channel(room, away);
    append(test::frames_at(other, kPlace, {.seed = seed++}), other, frames);
  }
  return frames;
}

// By the steps of it: every burst and hop as it is made of the frames of one channel.
LocationEstimate located_by_steps(const M3& m3, std::span<const CsiFrame> frames) {
  const RoomModel& room = m3.room();
  std::vector<std::size_t> tones(room.grid.size());
  std::iota(tones.begin(), tones.end(), std::size_t{0});
  std::vector<M3Paths> paths;
  for (std::size_t i = 0; i < room.access_points.size(); ++i) {
    const RoomAccessPoint& ap = room.access_points[i];
    M3Received received;
    received.access_point = i;
    for (const double away : kHops) {
      const RoomModel other = on_channel(room, away);
      std::vector<CsiFrame> own;
      std::copy_if(frames.begin(), frames.end(), std::back_inserter(own), [&](const auto& frame) {
        return frame.channel.value_or(channel_of(room)) == channel_of(other);
      });
      auto burst = combine_burst(own, {i, other.grid, ap.rx_chains, {}});
      if (!burst) {
        continue;
      }
      remove_gains(ap.gains, burst->h);
      std::vector<std::string> warnings;
      received.line = *living_line(ap, *burst, warnings);
      received.hops.push_back({other.grid, along(received.line, *burst, tones)});
    }
    paths.push_back(m3.find_paths(received));
  }
  LocationEstimate estimate;
  m3.summarise(paths, estimate);
  return estimate;
}

M3 m3_in(RoomModel room, const M3Options& options = {}) {
  return *M3::create(std::make_shared<const RoomModel>(std::move(room)), options);
}

TEST(M3Hops, GroupFramesByChannel) {
  const RoomModel room = test::make_room();
  std::vector<CsiFrame> frames(6);
  const double site = room.grid.centre_hz;
  frames[0].channel = RadioChannel{site + 80e6, 40};
  frames[1].channel = RadioChannel{site, 40};
  frames[3].channel = RadioChannel{site + 1e6, 40};  // as measured
  frames[4].channel = RadioChannel{site - 40e6, 40};
  frames[5].channel = RadioChannel{site + 80e6, 40};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].sequence = static_cast<std::uint16_t>(i);
  }
  const auto channels = by_channel(room.grid, frames);
  std::vector<double> centres;
  std::vector<std::vector<int>> numbers;
  for (const ChannelFrames& channel : channels) {
    centres.push_back(channel.grid.centre_hz);
    EXPECT_EQ(channel.grid.tone_index, room.grid.tone_index);
    EXPECT_EQ(channel.grid.spacing_hz, room.grid.spacing_hz);
    auto& own = numbers.emplace_back();
    for (const CsiFrame& frame : channel.frames) {
      own.push_back(frame.sequence);
    }
  }
  EXPECT_THAT(centres, ElementsAre(site - 40e6, site, site + 80e6));
  EXPECT_THAT(numbers, ElementsAre(ElementsAre(4), ElementsAre(1, 2, 3), ElementsAre(0, 5)));
  EXPECT_TRUE(by_channel(room.grid, {}).empty());
}

TEST(M3Hops, OneChannelGivesTheSingleChannelResult) {
  const M3 m3 = m3_in(test::make_room());
  std::vector<CsiFrame> frames = frames_on(m3.room(), std::span(kHops).first(1));
  const LocationEstimate stated = m3.locate(frames);
  for (CsiFrame& frame : frames) {
    frame.channel.reset();
  }
  const LocationEstimate silent = m3.locate(frames);
  const LocationEstimate by_steps = located_by_steps(m3, frames);
  ASSERT_TRUE(by_steps.position);
  for (const LocationEstimate* estimate : {&stated, &silent}) {
    EXPECT_EQ(estimate->position, by_steps.position);
    EXPECT_EQ(estimate->covariance, by_steps.covariance);
    EXPECT_THAT(estimate->warnings, ElementsAre(HasSubstr("without channel hopping")));
  }
}

TEST(M3Hops, FindPathsJointlyOverAllChannels) {
  const M3 m3 = m3_in(test::make_room());
  const std::vector<CsiFrame> frames = frames_on(m3.room(), kHops);
  const LocationEstimate estimate = m3.locate(frames);
  const LocationEstimate by_steps = located_by_steps(m3, frames);
  ASSERT_TRUE(estimate.position);
  EXPECT_EQ(estimate.position, by_steps.position);
  EXPECT_EQ(estimate.covariance, by_steps.covariance);
  EXPECT_EQ(estimate.frames_used, frames.size());
  EXPECT_EQ(estimate.access_points_used, 3U);
  EXPECT_EQ(estimate.antennas_used, 9U);
  EXPECT_EQ(estimate.capture_end, frames.back().time);
  EXPECT_THAT(estimate.warnings, Contains(HasSubstr("access point a: m3 hops over 4 channels")));
  EXPECT_THAT(estimate.warnings, Not(Contains(HasSubstr("without channel hopping"))));
  const LocationEstimate alone = m3.locate(frames_on(m3.room(), std::span(kHops).first(1)));
  EXPECT_NE(alone.position, estimate.position);
}

TEST(M3Hops, ReportASingleForeignChannel) {
  const M3 m3 = m3_in(test::make_room());
  const LocationEstimate estimate = m3.locate(frames_on(m3.room(), std::span(kHops).last(1)));
  EXPECT_TRUE(estimate.position);
  EXPECT_THAT(estimate.warnings, Contains(HasSubstr("without channel hopping")));
  EXPECT_THAT(estimate.warnings, Contains(HasSubstr("chain gains of the one at 5180.0 MHz")));
}

TEST(M3Hops, LeaveOutAChannelOfOtherAntennasAndOneThatIsNoHop) {
  const RoomModel room = test::make_room();
  std::vector<CsiFrame> frames = frames_on(room, kHops);
  for (CsiFrame& frame : frames) {
    if (frame.access_point != 0) {
      continue;
    }
    if (frame.channel == channel_of(on_channel(room, 40e6))) {
      for (auto& value : frame.csi.row(1, 0)) {
        value *= 1e-3F;
      }
    }
    if (frame.channel == channel_of(on_channel(room, 120e6))) {
      frame.rx_chains = {4, 5, 6};
    }
  }
  std::vector<std::string> warnings;
  const auto channels = by_channel(room.grid, frames);
  const auto hops = observe_hops(room, 0, channels, warnings);
  ASSERT_TRUE(hops);
  ASSERT_EQ(hops->received.hops.size(), 2U);
  EXPECT_EQ(hops->received.line.element.size(), 3U);
  EXPECT_EQ(hops->received.hops[1].grid.centre_hz, room.grid.centre_hz + 80e6);
  EXPECT_EQ(hops->burst.frames_used, 8U);
  EXPECT_THAT(warnings, Contains(HasSubstr("1 of 3 channels are left out")));
  EXPECT_THAT(warnings, Contains(HasSubstr("(at 5300 MHz)")));
  EXPECT_FALSE(observe_hops(room, 0, {}, warnings));
}

// Two paths from one direction, 8 ns apart.
std::vector<CsiFrame> two_paths(const RoomModel& room,
                                std::span<const double> hops,
                                unsigned seed) {
  constexpr double kSpacing = 0.089;  // [m], of the antennas of the room's access points
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  const double u = 1.6 * uniform() - 0.8;
  const auto later = std::polar(0.7, kTwoPi * uniform());
  std::vector<CsiFrame> frames;
  for (const double away : hops) {
    const RoomModel other = on_channel(room, away);
    std::vector<std::complex<double>> h;
    for (int m = 0; m < 3; ++m) {
      const double phase = kTwoPi * other.grid.centre_hz * kSpacing * m * u / 299'792'458.0;
      for (std::size_t k = 0; k < other.grid.size(); ++k) {
        const double delayed = -kTwoPi * other.grid.frequency_hz(k) * 8e-9;
        h.push_back(std::polar(1.0, phase) * (1.0 + later * std::polar(1.0, delayed)));
      }
    }
    append(test::frames_of(other, {h}, {.seed = seed++}), other, frames);
  }
  return frames;
}

// 40 MHz resolve 25 ns, four such channels side by side 6 ns.
TEST(M3Hops, ResolveAPathThatOneChannelDoesNot) {
  RoomModel room = test::make_room();
  room.access_points.resize(1);
  const M3 m3 = m3_in(room);
  const auto median_error = [&](std::span<const double> hops) {
    std::vector<double> errors;  // [s], of the delay between the two strongest paths
    for (unsigned seed = 1; seed <= 20; ++seed) {
      std::vector<std::string> warnings;
      const auto channels = by_channel(room.grid, two_paths(room, hops, 100 * seed));
      M3Paths found = m3.find_paths(observe_hops(room, 0, channels, warnings)->received);
      std::sort(found.paths.begin(), found.paths.end(), [](const auto& a, const auto& b) {
        return std::abs(a.amplitude) > std::abs(b.amplitude);
      });
      const double apart =
          found.paths.size() < 2 ? 0.0 : std::abs(found.paths[1].tau - found.paths[0].tau);
      errors.push_back(std::abs(apart - 8e-9));
    }
    return median(errors);
  };
  EXPECT_LT(median_error(kHops), 1e-9);
  EXPECT_GT(median_error(std::span(kHops).first(1)), 4e-9);
}

}  // namespace
}  // namespace rayloc::m3_hops_test
