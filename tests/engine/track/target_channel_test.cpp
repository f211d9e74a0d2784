#include "engine/track/target_channel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace rayloc::target_channel_test {
namespace {

constexpr std::size_t kAntennas = 2;
constexpr double kCaptured = 0.99;  // share of the power at the delays of a room
constexpr TargetChannel::Limits kLimits{0.005, 5.0, 0.25};

OfdmGrid band() {
  OfdmGrid grid;
  grid.centre_hz = 5.5e9;
  for (int tone = -28; tone <= 28; ++tone) {
    grid.tone_index.push_back(static_cast<std::int16_t>(tone));
  }
  return grid;
}

// Two paths per antenna; `moved` rotates the second one [rad].
ArrayObservation array_of(std::size_t ap, double moved, double captured = kCaptured) {
  ArrayObservation array;
  array.ap = ap;
  array.observed.array.captured = captured;
  for (std::size_t antenna = 0; antenna < kAntennas; ++antenna) {
    for (std::size_t tone = 0; tone < band().size(); ++tone) {
      const double offset = band().offset_hz(tone);
      const double turned = static_cast<double>(antenna) + moved;
      array.h.push_back(std::polar(1.0, 0.4 * static_cast<double>(antenna)) +
                        std::polar(1.0, turned - 2.0 * std::numbers::pi * offset * 40e-9));
    }
  }
  return array;
}

RoomObservation moment(std::vector<ArrayObservation> arrays) {
  RoomObservation observation;
  observation.arrays = std::move(arrays);
  return observation;
}

TEST(TargetChannel, IsUnknownWithoutACommonAccessPoint) {
  TargetChannel change(band(), kLimits);
  EXPECT_FALSE(change.of(moment({array_of(0, 0.0)})));
  change.remember(moment({array_of(0, 0.0)}));
  EXPECT_TRUE(change.of(moment({array_of(0, 0.0)})));
  EXPECT_FALSE(change.of(moment({array_of(1, 0.0)})));
  ArrayObservation without_antenna = array_of(0, 0.0);
  without_antenna.h.resize(without_antenna.h.size() / kAntennas);
  EXPECT_FALSE(change.of(moment({without_antenna})));
  change.forget();
  EXPECT_FALSE(change.of(moment({array_of(0, 0.0)})));
}

TEST(TargetChannel, IsTheMeanOverCommonAccessPoints) {
  TargetChannel change(band(), kLimits);
  change.remember(moment({array_of(0, 0.0), array_of(1, 0.0)}));
  const double same = change.of(moment({array_of(0, 0.0)})).value().power;
  const double moved = change.of(moment({array_of(0, 0.8)})).value().power;
  EXPECT_GT(same, 0.0);
  EXPECT_LT(same, 1e-4);
  EXPECT_GT(moved, 0.05);
  EXPECT_LT(moved, 0.5);
  EXPECT_NEAR(
      change.of(moment({array_of(0, 0.8), array_of(1, 0.0), array_of(2, 0.8)})).value().power,
      0.5 * (moved + same),
      1e-12);
}

// A factor and a delay are not a change of the channel.
TEST(TargetChannel, LeavesOutFactorAndDelay) {
  TargetChannel change(band(), kLimits);
  change.remember(moment({array_of(0, 0.0)}));
  ArrayObservation later = array_of(0, 0.0);
  const OfdmGrid grid = band();
  for (std::size_t i = 0; i < later.h.size(); ++i) {
    const double offset = grid.offset_hz(i % grid.size());
    later.h[i] *= std::polar(3.0, 1.0 - 2.0 * std::numbers::pi * offset * 9e-9);
  }
  EXPECT_LT(change.of(moment({later})).value().power, 1e-4);
}

// Access points that receive different moments keep their arrays.
TEST(TargetChannel, RemembersEachAccessPoint) {
  TargetChannel change(band(), kLimits);
  change.remember(moment({array_of(0, 0.0)}));
  const auto both = moment({array_of(0, 0.0), array_of(1, 0.0)});
  EXPECT_FALSE(change.of(both).value().is_of_all);
  EXPECT_FALSE(change.of(both).value().is_rest);
  change.remember(moment({array_of(1, 0.0)}));
  EXPECT_TRUE(change.of(both).value().is_of_all);
  EXPECT_TRUE(change.of(moment({array_of(0, 0.0)})).value().is_rest);
  EXPECT_FALSE(change.of(moment({array_of(0, 0.8)})).value().is_rest);
  change.remember(moment({array_of(0, 0.8)}));
  EXPECT_TRUE(change.of(moment({array_of(0, 0.8)})).value().is_rest);
  EXPECT_TRUE(change.of(moment({array_of(1, 0.0)})).value().is_rest);
}

// An array without a dead chain does not replace the one with all chains.
TEST(TargetChannel, RemembersEachSizeOfAnArray) {
  TargetChannel change(band(), kLimits);
  ArrayObservation without_chain = array_of(0, 0.0);
  without_chain.h.resize(without_chain.h.size() / kAntennas);
  change.remember(moment({array_of(0, 0.0)}));
  change.remember(moment({without_chain}));
  EXPECT_TRUE(change.of(moment({array_of(0, 0.0)})).value().is_rest);
  EXPECT_TRUE(change.of(moment({without_chain})).value().is_rest);
}

// An equal channel shows a rest only if the noise would not hide a movement.
TEST(TargetChannel, NoiseThatHidesAMovementIsNoRest) {
  TargetChannel change(band(), kLimits);
  change.remember(moment({array_of(0, 0.0, 0.9)}));
  EXPECT_TRUE(change.of(moment({array_of(0, 0.0, 0.9)})).value().is_rest);
  EXPECT_FALSE(change.of(moment({array_of(0, 0.0, 0.8)})).value().is_rest);
}

// Over the access points that are compared, at both moments.
TEST(TargetChannel, NoiseIsThatOfTheComparedArrays) {
  TargetChannel change(band(), kLimits);
  change.remember(moment({array_of(0, 0.0, 0.99), array_of(1, 0.0, 0.95)}));
  const auto now = moment({array_of(0, 0.0, 0.97), array_of(1, 0.0, 0.99), array_of(2, 0.0, 0.5)});
  EXPECT_NEAR(change.of(now).value().unmoved, 0.005 + 0.5 * (0.04 + 0.06), 1e-12);
}

TEST(TargetChannel, MotionExceedsNoiseAndTheRadio) {
  const TargetChannel change(band(), kLimits);
  constexpr double kStill = 0.03;
  EXPECT_EQ(change.motion_of({0.5 * kStill, kStill}), 0.0);
  EXPECT_NEAR(change.motion_of({kStill, kStill}), 0.0, 1e-9);
  EXPECT_NEAR(change.motion_of({std::sqrt(5.0) * kStill, kStill}), 0.5, 1e-9);
  EXPECT_EQ(change.motion_of({6.0 * kStill, kStill}), 1.0);
}

}  // namespace
}  // namespace rayloc::target_channel_test
