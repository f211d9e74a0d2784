// Bursts of which one receive chain brought nothing.
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/observe/burst.h"

namespace rayloc::field_absent_core_test {
namespace {

constexpr std::size_t kTones = 64;
const std::vector<std::uint8_t> kRxChains = {0, 2, 3};

OfdmGrid grid() {
  OfdmGrid grid{5.19e9, 312'500.0, {}};
  for (std::size_t k = 0; k < kTones; ++k) {
    grid.tone_index.push_back(static_cast<std::int16_t>(k));
  }
  return grid;
}

// The same channel in every frame, another phase, and a little noise.
std::vector<CsiFrame> frames(int count) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::vector<CsiFrame> all;
  for (int i = 0; i < count; ++i) {
    CsiFrame frame;
    frame.time = Timestamp(std::chrono::milliseconds(20 * i));
    frame.rx_chains = kRxChains;
    frame.tone_index = grid().tone_index;
    frame.csi = Csi(3, 1, kTones);
    for (std::size_t m = 0; m < 3; ++m) {
      for (std::size_t k = 0; k < kTones; ++k) {
        const float angle = 0.05F * static_cast<float>((m + 1) * k) + 1.7F * static_cast<float>(i);
        frame.csi.row(m, 0)[k] = std::polar(1.0F + 0.3F * static_cast<float>(m), angle) +
                                 0.02F * std::complex<float>(normal(random), normal(random));
      }
    }
    all.push_back(std::move(frame));
  }
  return all;
}

void lose(CsiFrame& frame, std::size_t row) {
  Csi csi(frame.csi.antennas() - 1, 1, kTones);
  for (std::size_t m = 0, to = 0; m < frame.csi.antennas(); ++m) {
    if (m != row) {
      std::ranges::copy(frame.csi.row(m, 0), csi.row(to++, 0).begin());
    }
  }
  frame.csi = std::move(csi);
  frame.rx_chains.erase(frame.rx_chains.begin() + static_cast<std::ptrdiff_t>(row));
}

Expected<BurstObservation> combined(const std::vector<CsiFrame>& frames) {
  return combine_burst(frames, {0, grid(), kRxChains, {.leaves_out_absent = true}});
}

bool is_zero_row(const BurstObservation& burst, std::size_t row) {
  return std::all_of(burst.h.begin() + static_cast<std::ptrdiff_t>(row * kTones),
                     burst.h.begin() + static_cast<std::ptrdiff_t>((row + 1) * kTones),
                     [](const auto& value) { return std::abs(value) == 0.0; });
}

TEST(Field, BurstIsMadeOfTheOtherChainsWhereNoFrameHasOne) {
  for (std::size_t row = 0; row < 3; ++row) {
    auto all = frames(3);
    for (CsiFrame& frame : all) {
      lose(frame, row);
    }
    const auto burst = combined(all);
    ASSERT_TRUE(burst) << burst.error().message;
    ASSERT_TRUE(burst->absent);
    EXPECT_EQ(burst->absent->row, row);
    EXPECT_FALSE(burst->absent->is_lasting) << "datagrams may have been lost";
    EXPECT_EQ(burst->frames_used, 3U);
    EXPECT_EQ(burst->rx_chains, kRxChains);
    EXPECT_TRUE(is_zero_row(*burst, row));
    EXPECT_LT(burst->noise_variance, 1e-3);
    EXPECT_FALSE(combine_burst(all, {0, grid(), kRxChains, {}})) << "unless it is asked for";
  }
}

TEST(Field, ChainThatBringsZerosOrOneValueOrNoNumberIsAbsent) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const std::complex<float> value :
       {std::complex<float>(), std::complex<float>(0.7F, -0.1F), std::complex<float>(nan, nan)}) {
    auto all = frames(3);
    for (CsiFrame& frame : all) {
      std::ranges::fill(frame.csi.row(1, 0), value);
    }
    const auto burst = combined(all);
    ASSERT_TRUE(burst) << burst.error().message;
    ASSERT_TRUE(burst->absent);
    EXPECT_EQ(burst->absent->row, 1U);
    EXPECT_TRUE(burst->absent->is_lasting) << "its datagrams have come";
    EXPECT_TRUE(is_zero_row(*burst, 1));
  }
}

TEST(Field, FramesThatHaveAllChainsAreUsedAlone) {
  auto all = frames(4);
  lose(all[0], 1);
  lose(all[2], 2);
  const auto burst = combined(all);
  ASSERT_TRUE(burst);
  EXPECT_FALSE(burst->absent);
  EXPECT_EQ(burst->frames_used, 2U);
  EXPECT_EQ(burst->refused.at("missing_core"), 2U);
}

TEST(Field, ChainThatMostFramesLackIsLeftOutWhereFramesLackDifferentOnes) {
  auto all = frames(3);
  lose(all[0], 1);
  lose(all[1], 2);
  lose(all[2], 2);
  const auto burst = combined(all);
  ASSERT_TRUE(burst);
  ASSERT_TRUE(burst->absent);
  EXPECT_EQ(burst->absent->row, 2U);
  EXPECT_EQ(burst->frames_used, 2U);
}

TEST(Field, BurstOfOneChainAloneIsRefused) {
  auto all = frames(2);
  for (CsiFrame& frame : all) {
    lose(frame, 2);
    lose(frame, 1);
  }
  const auto burst = combined(all);
  ASSERT_FALSE(burst);
  EXPECT_NE(burst.error().message.find("missing_core"), std::string::npos);
}

}  // namespace
}  // namespace rayloc::field_absent_core_test
