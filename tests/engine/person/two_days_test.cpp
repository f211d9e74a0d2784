#include "engine/person/calibrate/two_days.h"

#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/person/person_localizer.h"
#include "engine/room/preprocess_burst.h"
#include "tests/support/person_in_room.h"

namespace rayloc::two_days_test {
namespace {

using Value = std::complex<double>;
using Channels = std::vector<std::vector<Value>>;

const std::vector<double> kPhases = {0.0, 2.4, -1.1};  // [rad], by which the chains turn
const std::vector<double> kLevels = {1.0, 1.3, 0.8};

Value turn_of(std::size_t access_point, std::size_t rx_chain) {
  return std::polar(kLevels[rx_chain], kPhases[rx_chain] * (access_point == 1 ? -0.7 : 1.0));
}

// The same radios after a power cycle.
RoomModel rotated_room(RoomModel room) {
  for (std::size_t a = 0; a < room.access_points.size(); ++a) {
    std::vector<Value>& gain = room.access_points[a].gains.gain;
    for (std::size_t j = 0; j < gain.size(); ++j) {
      gain[j] *= turn_of(a, j / room.grid.size());
    }
  }
  return room;
}

// The channels of these rotated radios, as input for radios without a power cycle.
Channels rotated_channels(const OfdmGrid& grid, Channels channels) {
  for (std::size_t a = 0; a < channels.size(); ++a) {
    for (std::size_t j = 0; j < channels[a].size(); ++j) {
      channels[a][j] *= turn_of(a, j / grid.size());
    }
  }
  return channels;
}

std::vector<EmptyRoom> received_by(const RoomModel& room, const std::vector<CsiFrame>& frames) {
  std::vector<EmptyRoom> received;
  std::vector<std::string> warnings;
  for (std::size_t a = 0; a < room.access_points.size(); ++a) {
    received.push_back({a, preprocess_burst(room, a, frames, {}, warnings)->h});
  }
  return received;
}

std::vector<CsiFrame> frames_of_empty(const RoomModel& room,
                                      const Channels& channels,
                                      unsigned seed) {
  return test::frames_of(room, channels, {.count = 20, .snr_db = 35.0, .seed = seed});
}

// Phase of a chain of one access point against the first chain, between the gains of two rooms.
double phase_off(const RoomModel& one,
                 const RoomModel& other,
                 std::size_t ap,
                 std::size_t rx_chain) {
  const auto ratio = [&](const RoomModel& room) {
    const auto& gain = room.access_points[ap].gains.gain;
    return gain[rx_chain * room.grid.size()] / gain[0];
  };
  return std::arg(ratio(one) / ratio(other));
}

class TwoDaysTest : public ::testing::Test {
 protected:
  TwoDaysTest() : empty_(test::channels_past(room_, {})) {}

  // `calibrated`: the room with the calibration's gains.
  ReceivedDays received(const RoomModel& calibrated, const Channels& today) const {
    return {
        test::fixed_transmitter(),
        received_by(calibrated, frames_of_empty(room_, empty_, 1)),
        received_by(calibrated, frames_of_empty(room_, rotated_channels(room_.grid, today), 2))};
  }

  const RoomModel room_ = test::make_room();
  const RoomModel later_ = rotated_room(room_);
  const Channels empty_;
};

TEST_F(TwoDaysTest, RotatedChainsChangeNoEstimate) {
  const std::vector<ReceivedDays> received_days = {received(room_, empty_)};
  const auto days = separate_days(room_, received_days);
  ASSERT_TRUE(days) << days.error().message;
  ASSERT_EQ(days->changes.size(), 3U);
  for (const DayChange& change : days->changes) {
    EXPECT_TRUE(change.is_rotated);
    EXPECT_TRUE(change.is_today_rotated);
    EXPECT_LT(change.chains.changed, 0.002);
    for (std::size_t rx_chain = 1; rx_chain < 3; ++rx_chain) {
      EXPECT_NEAR(phase_off(days->today, later_, change.access_point, rx_chain), 0.0, 0.02);
    }
    EXPECT_EQ(days->people.access_points[change.access_point].gains.gain,
              room_.access_points[change.access_point].gains.gain);
  }
  const auto reference =
      fit_empty_room(days->people, test::fixed_transmitter(), days->received[0].people);
  ASSERT_TRUE(reference);
  const auto before =
      PersonLocalizer::create(std::make_shared<const RoomModel>(room_), *reference, {});
  const auto after =
      PersonLocalizer::create(std::make_shared<const RoomModel>(days->today),
                              moved_to_today(room_.grid, *reference, days->received[0].today),
                              {});
  ASSERT_TRUE(before && after);
  unsigned seed = 1;
  for (const TargetPosition& place : {TargetPosition{0.2, 0.3}, {-0.7, -0.2}, {0.4, -0.5}}) {
    const Channels channels = test::channels_past(room_, {place}, PersonModel{}.body);
    const auto here = before->locate(test::frames_of(room_, channels, {.count = 8, .seed = seed}));
    const auto there = after->locate(
        test::frames_of(room_, rotated_channels(room_.grid, channels), {.count = 8, .seed = seed}));
    ASSERT_TRUE(here.position && there.position) << there.reason;
    EXPECT_LT(norm(*here.position - *there.position), 0.01);
    EXPECT_LT(std::hypot(there.position->x - place.x, there.position->y - place.y), 0.08);
    ++seed;
  }
}

// If the chains of a site were renewed first, the calibration has today's gains.
TEST_F(TwoDaysTest, AcceptsGainsOfTheSecondDay) {
  const std::vector<ReceivedDays> received_days = {received(later_, empty_)};
  const auto days = separate_days(later_, received_days);
  ASSERT_TRUE(days) << days.error().message;
  for (const DayChange& change : days->changes) {
    EXPECT_TRUE(change.is_rotated);
    EXPECT_FALSE(change.is_today_rotated);
    for (std::size_t rx_chain = 1; rx_chain < 3; ++rx_chain) {
      EXPECT_NEAR(phase_off(days->people, room_, change.access_point, rx_chain), 0.0, 0.02);
      EXPECT_NEAR(phase_off(days->today, later_, change.access_point, rx_chain), 0.0, 1e-12);
    }
  }
}

TEST_F(TwoDaysTest, ChainsThatAreAsTheyWereKeepTheirGains) {
  ReceivedDays same = received(room_, empty_);
  same.today = received_by(room_, frames_of_empty(room_, empty_, 3));
  const auto days = separate_days(room_, std::vector{same});
  ASSERT_TRUE(days) << days.error().message;
  for (const DayChange& change : days->changes) {
    EXPECT_FALSE(change.is_rotated);
    EXPECT_EQ(days->today.access_points[change.access_point].gains.gain,
              room_.access_points[change.access_point].gains.gain);
  }
}

// An object was moved: an echo of a hundredth of the power, 12 ns late.
TEST_F(TwoDaysTest, AMovedObjectIsNotMistakenForAChain) {
  Channels today = empty_;
  for (std::vector<Value>& h : today) {
    double power = 0.0;
    for (const Value& value : h) {
      power += std::norm(value) / static_cast<double>(h.size());
    }
    for (std::size_t j = 0; j < h.size(); ++j) {
      const std::size_t rx_chain = j / room_.grid.size();
      const double turn =
          -2.0 * std::numbers::pi * room_.grid.offset_hz(j % room_.grid.size()) * 12e-9;
      h[j] += std::polar(0.1 * std::sqrt(power), turn + 1.3 * static_cast<double>(rx_chain));
    }
  }
  const auto days = separate_days(room_, std::vector{received(room_, today)});
  ASSERT_TRUE(days) << days.error().message;
  for (const DayChange& change : days->changes) {
    EXPECT_TRUE(change.is_rotated);
    EXPECT_GT(change.chains.changed, 0.001);
    EXPECT_LT(change.chains.changed, 0.03);
    for (std::size_t rx_chain = 1; rx_chain < 3; ++rx_chain) {
      const double known = std::hypot(change.chains.sigma[0], change.chains.sigma[rx_chain]);
      EXPECT_LT(std::abs(phase_off(days->today, later_, change.access_point, rx_chain)),
                3.0 * known);
      EXPECT_LT(known, 0.25);
    }
  }
}

// Echoes that have nothing to do with the room's, as strong as one another.
TEST_F(TwoDaysTest, RefusesAnotherTransmitterAsASecondDay) {
  Channels today = empty_;
  for (std::vector<Value>& h : today) {
    for (std::size_t j = 0; j < h.size(); ++j) {
      const double w = 2.0 * std::numbers::pi * room_.grid.offset_hz(j % room_.grid.size());
      const std::size_t number = j / room_.grid.size();
      const auto rx_chain = static_cast<double>(number);
      h[j] = std::polar(1.0, -w * 10e-9) + std::polar(1.0, -w * 45e-9 + rx_chain) +
             std::polar(1.0, -w * 70e-9 - 2.0 * rx_chain);
    }
  }
  const auto days = separate_days(room_, std::vector{received(room_, today)});
  ASSERT_FALSE(days);
  EXPECT_NE(days.error().message.find("access point a: the empty rooms of the two days"),
            std::string::npos)
      << days.error().message;
}

TEST_F(TwoDaysTest, AnAccessPointIsNeededOnBothDays) {
  ReceivedDays apart = received(room_, empty_);
  apart.people.resize(1);
  apart.today.erase(apart.today.begin());
  const auto days = separate_days(room_, std::vector{apart});
  ASSERT_FALSE(days);
  EXPECT_NE(days.error().message.find("both days"), std::string::npos) << days.error().message;
}

}  // namespace
}  // namespace rayloc::two_days_test
