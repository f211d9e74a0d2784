#include "engine/channel/tone_plan.h"

#include <algorithm>
#include <cstdlib>

#include <gtest/gtest.h>

namespace rayloc::tone_plan_test {
namespace {

constexpr PhyFormat kAll[] = {PhyFormat::kLegacy, PhyFormat::kHt, PhyFormat::kVht, PhyFormat::kHe};
constexpr int kBandwidths[] = {20, 40, 80, 160};

TEST(TonePlan, HasAsManyTonesAsTheStandardSounds) {
  // Legacy 52 a 20 MHz part; HT and VHT table 21-5 (N_ST); HE the tones of the widest RU.
  const std::size_t counts[4][4] = {
      {52, 104, 208, 416}, {56, 114, 242, 484}, {56, 114, 242, 484}, {242, 484, 996, 1992}};
  for (std::size_t p = 0; p < 3; ++p) {
    for (std::size_t b = 0; b < 4; ++b) {
      EXPECT_EQ(tone_plan(kAll[p], kBandwidths[b]).active.size(), counts[p][b]);
    }
  }
  for (std::size_t b = 0; b < 3; ++b) {
    EXPECT_EQ(tone_plan(PhyFormat::kHe, kBandwidths[b]).active.size(), counts[3][b]);
  }
  // At 160 MHz the standard sounds 1992; the converter zeroes 1012 and -515 as well
  // (WIRE_FORMATS 1.4).
  EXPECT_EQ(tone_plan(PhyFormat::kHe, 160).active.size(), 1990U);
}

TEST(TonePlan, PilotsAreActiveTonesAndSymmetric) {
  for (const PhyFormat phy : kAll) {
    for (const int bandwidth : kBandwidths) {
      const TonePlan& plan = tone_plan(phy, bandwidth);
      for (const std::int16_t pilot : plan.pilots) {
        EXPECT_TRUE(std::binary_search(plan.active.begin(), plan.active.end(), pilot)) << pilot;
        EXPECT_TRUE(std::binary_search(plan.pilots.begin(), plan.pilots.end(), -pilot)) << pilot;
      }
      EXPECT_TRUE(std::is_sorted(plan.active.begin(), plan.active.end()));
      EXPECT_TRUE(std::is_sorted(plan.pilots.begin(), plan.pilots.end()));
      EXPECT_EQ(plan.quarter_turns.size(), plan.active.size());
    }
  }
}

TEST(TonePlan, NoTonePlanTouchesTheCentre) {
  for (const PhyFormat phy : kAll) {
    for (const int bandwidth : kBandwidths) {
      const TonePlan& plan = tone_plan(phy, bandwidth);
      EXPECT_FALSE(std::binary_search(plan.active.begin(), plan.active.end(), 0));
      EXPECT_LT(plan.active.back(), transform_size(phy, bandwidth) / 2);
      EXPECT_GE(plan.active.front(), -transform_size(phy, bandwidth) / 2);
    }
  }
}

TEST(TonePlan, SpansTheSameBandwidthForAnySpacing) {
  for (const PhyFormat phy : kAll) {
    for (const int bandwidth : kBandwidths) {
      EXPECT_EQ(transform_size(phy, bandwidth) * tone_spacing_hz(phy), bandwidth * 1e6);
    }
  }
}

std::uint8_t turns_at(const TonePlan& plan, int tone) {
  const auto found = std::find(plan.active.begin(), plan.active.end(), tone);
  EXPECT_NE(found, plan.active.end());
  return plan.quarter_turns[static_cast<std::size_t>(found - plan.active.begin())];
}

TEST(TonePlan, RotatesAsTheStandardDoes) {
  const TonePlan& at40 = tone_plan(PhyFormat::kVht, 40);
  EXPECT_EQ(turns_at(at40, -2), 0);
  EXPECT_EQ(turns_at(at40, 2), 1);
  const TonePlan& at80 = tone_plan(PhyFormat::kVht, 80);
  EXPECT_EQ(turns_at(at80, -65), 0);
  EXPECT_EQ(turns_at(at80, -64), 2);
  EXPECT_EQ(turns_at(at80, 122), 2);
  const TonePlan& at160 = tone_plan(PhyFormat::kVht, 160);
  EXPECT_EQ(turns_at(at160, -193), 0);
  EXPECT_EQ(turns_at(at160, -192), 2);
  EXPECT_EQ(turns_at(at160, 63), 0);
  EXPECT_EQ(turns_at(at160, 64), 2);
  EXPECT_EQ(turns_at(tone_plan(PhyFormat::kHe, 80), 100), 0);
  EXPECT_EQ(turns_at(tone_plan(PhyFormat::kLegacy, 40), 6), 1);
}

}  // namespace
}  // namespace rayloc::tone_plan_test
