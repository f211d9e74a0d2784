#include "engine/observe/burst.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "engine/observe/alignment.h"

namespace rayloc::burst_test {
namespace {

using Value = std::complex<double>;

OfdmGrid vht40() {
  OfdmGrid grid{5.19e9, 312'500.0, {}};
  for (int k = -58; k <= 58; ++k) {
    if (k < -1 || k > 1) {
      grid.tone_index.push_back(static_cast<std::int16_t>(k));
    }
  }
  return grid;
}

// Three chains, five echoes each, unit mean square.
std::vector<Value> channel(const OfdmGrid& grid, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Value> h(3 * grid.size());
  for (std::size_t m = 0; m < 3; ++m) {
    for (int echo = 0; echo < 5; ++echo) {
      const Value a(normal(random), normal(random));
      const double delay = 1e-8 * echo;
      for (std::size_t k = 0; k < grid.size(); ++k) {
        h[m * grid.size() + k] +=
            a * std::polar(1.0, -2.0 * std::numbers::pi * grid.offset_hz(k) * delay);
      }
    }
  }
  double power = 0.0;
  for (const Value& v : h) {
    power += std::norm(v);
  }
  for (Value& v : h) {
    v /= std::sqrt(power / static_cast<double>(h.size()));
  }
  return h;
}

// A frame as the radio makes it: random gain, phase and timing offset, and noise.
CsiFrame frame_of(const std::vector<Value>& h,
                  const OfdmGrid& grid,
                  double noise,
                  std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  CsiFrame frame;
  frame.rx_chains = {0, 2, 3};
  frame.tone_index = grid.tone_index;
  frame.csi = Csi(3, 1, grid.size());
  frame.complete = true;
  const double delay = 60e-9 + 300e-9 * uniform(random);
  const Value factor =
      std::polar(std::exp(normal(random)), 2.0 * std::numbers::pi * uniform(random));
  for (std::size_t m = 0; m < 3; ++m) {
    auto row = frame.csi.row(m, 0);
    for (std::size_t k = 0; k < grid.size(); ++k) {
      const Value value =
          factor * (h[m * grid.size() + k] *
                        std::polar(1.0, -2.0 * std::numbers::pi * grid.offset_hz(k) * delay) +
                    std::sqrt(noise / 2.0) * Value(normal(random), normal(random)));
      row[k] = std::complex<float>(value);
    }
  }
  return frame;
}

std::vector<CsiFrame> frames_of(const std::vector<Value>& h,
                                const OfdmGrid& grid,
                                int count,
                                double noise) {
  std::mt19937 random(7);
  std::vector<CsiFrame> frames;
  for (int i = 0; i < count; ++i) {
    frames.push_back(frame_of(h, grid, noise, random));
    frames.back().time = Timestamp(std::chrono::milliseconds(10 * i));
  }
  return frames;
}

BurstRequest request_of(const OfdmGrid& grid) { return {0, grid, {0, 2, 3}, {}}; }

TEST(Aligner, FindsDelayAndFactor) {
  const OfdmGrid grid = vht40();
  const auto h = channel(grid, 1);
  auto moved = h;
  const Aligner aligner(grid);
  aligner.apply({-123.4e-9, Value(0.3, -2.0), 0.0}, moved);
  const Alignment found = aligner.align(h, moved);
  EXPECT_NEAR(found.delay, 123.4e-9, 1e-14);
  EXPECT_NEAR(std::abs(found.factor * Value(0.3, -2.0) - 1.0), 0.0, 1e-9);
  EXPECT_NEAR(found.correlation, 1.0, 1e-12);
}

TEST(Burst, RecoversTheChannelUpToOneFactorAndOneDelay) {
  const OfdmGrid grid = vht40();
  const auto h = channel(grid, 2);
  const double noise = 1e-3;  // 30 dB
  const auto frames = frames_of(h, grid, 20, noise);
  const auto burst = combine_burst(frames, request_of(grid));
  ASSERT_TRUE(burst) << burst.error().message;
  EXPECT_EQ(burst->frames_used, 20U);
  // The difference is the noise of the average, a twentieth of one frame's.
  EXPECT_LT(1.0 - Aligner(grid).align(h, burst->h).correlation, 1.5 * noise / 20.0);
  EXPECT_NEAR(burst->snr_db, 30.0, 0.5);
  EXPECT_NEAR(burst->noise_variance, noise / 20.0, 0.1 * noise / 20.0);
  EXPECT_LT(burst->motion_residual, 1e-4);
  EXPECT_EQ(burst->first, frames.front().time);
  EXPECT_EQ(burst->last, frames.back().time);
}

TEST(Burst, ReadsABoundedNumberOfFramesSpreadOverTheBurst) {
  const OfdmGrid grid = vht40();
  const auto frames = frames_of(channel(grid, 3), grid, 100, 1e-3);
  BurstRequest request = request_of(grid);
  request.options.max_frames = 8;
  const auto burst = combine_burst(frames, request);
  ASSERT_TRUE(burst);
  EXPECT_EQ(burst->frames_used, 8U);
  EXPECT_EQ(burst->frames_unread, 92U);
  EXPECT_EQ(burst->first, frames.front().time);
  EXPECT_EQ(burst->last, frames.back().time);
}

TEST(Burst, SeesMotion) {
  const OfdmGrid grid = vht40();
  std::mt19937 random(5);
  std::vector<CsiFrame> frames;
  for (int i = 0; i < 20; ++i) {
    // A quarter of the power changes half-way through.
    auto h = channel(grid, 4);
    const auto other = channel(grid, i < 10 ? 5 : 6);
    for (std::size_t j = 0; j < h.size(); ++j) {
      h[j] += other[j] / std::sqrt(3.0);
    }
    frames.push_back(frame_of(h, grid, 1e-3, random));
  }
  const auto burst = combine_burst(frames, request_of(grid));
  ASSERT_TRUE(burst);
  EXPECT_EQ(burst->frames_used, 20U);
  EXPECT_GT(burst->motion_residual, 0.2);
}

TEST(Burst, RefusesUnusableFramesWithAReason) {
  const OfdmGrid grid = vht40();
  auto frames = frames_of(channel(grid, 8), grid, 10, 1e-3);
  frames[1].rx_chains = {0, 1, 2};
  frames[2].csi = Csi(3, 2, grid.size());
  frames[3].tone_index.front() = -64;
  frames[4].csi = Csi(3, 1, grid.size());
  std::mt19937 random(9);
  frames[5] = frame_of(channel(grid, 10), grid, 1e-3, random);  // of another transmitter
  const auto burst = combine_burst(frames, request_of(grid));
  ASSERT_TRUE(burst);
  EXPECT_EQ(burst->frames_used, 5U);
  EXPECT_EQ(burst->refused.at("missing_core"), 1U);
  EXPECT_EQ(burst->refused.at("several_streams"), 1U);
  EXPECT_EQ(burst->refused.at("wrong_grid"), 1U);
  EXPECT_EQ(burst->refused.at("dead_core"), 1U);
  EXPECT_EQ(burst->refused.at("different"), 1U);
}

TEST(Burst, WithoutAUsableFrameIsAnErrorThatCounts) {
  const OfdmGrid grid = vht40();
  auto frames = frames_of(channel(grid, 8), grid, 3, 1e-3);
  for (CsiFrame& frame : frames) {
    frame.rx_chains = {0, 1, 2};
  }
  const auto burst = combine_burst(frames, request_of(grid));
  ASSERT_FALSE(burst);
  EXPECT_EQ(burst.error().message, "no usable frame among 3 (3 missing_core)");
}

TEST(Burst, BoundsTheNoiseOfASingleFrame) {
  const OfdmGrid grid = vht40();
  const auto frames = frames_of(channel(grid, 11), grid, 1, 1e-2);
  const auto burst = combine_burst(frames, request_of(grid));
  ASSERT_TRUE(burst);
  EXPECT_GT(burst->noise_variance, 0.8e-2);
  EXPECT_LT(burst->noise_variance, 2e-2);
}

// Powers of cores 0, 2 and 3, and of core 1, which is not requested and is ten times louder.
std::vector<CsiFrame> stated_frames(const std::vector<float>& of_each_frame) {
  const OfdmGrid grid = vht40();
  auto frames = frames_of(channel(grid, 12), grid, static_cast<int>(of_each_frame.size()), 1e-3);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    CsiFrame& frame = frames[i];
    const Csi received = frame.csi;
    frame.rx_chains = {1, 0, 2, 3};
    frame.csi = Csi(4, 1, grid.size());
    for (std::size_t m = 0; m < 4; ++m) {
      const auto from = received.row(m == 0 ? 0 : m - 1, 0);
      std::copy(from.begin(), from.end(), frame.csi.row(m, 0).begin());
    }
    frame.power_dbm = {of_each_frame[i] + 10.0F,
                       of_each_frame[i],
                       of_each_frame[i] + 3.0F,
                       of_each_frame[i] - 6.0F};
  }
  return frames;
}

// Mean power of the cores of stated_frames() above what is stated of each [dB].
double mean_above() {
  return 10.0 * std::log10((1.0 + std::pow(10.0, 0.3) + std::pow(10.0, -0.6)) / 3.0);
}

TEST(Burst, KeepsTheMeanPowerOfItsCoresAndTheMedianOfItsFrames) {
  const auto burst =
      combine_burst(stated_frames({-50.0F, -53.0F, -80.0F, -52.0F, -51.0F}), request_of(vht40()));
  ASSERT_TRUE(burst) << burst.error().message;
  ASSERT_TRUE(burst->power_dbm);
  EXPECT_NEAR(*burst->power_dbm, -52.0 + mean_above(), 1e-6);
}

TEST(Burst, TakesThePowerOfTheFramesThatStateItOfAllItsCores) {
  auto frames = stated_frames({-50.0F, -60.0F, -70.0F});
  frames[1].power_dbm[3].reset();
  frames[2].power_dbm.clear();
  const auto burst = combine_burst(frames, request_of(vht40()));
  ASSERT_TRUE(burst) << burst.error().message;
  EXPECT_EQ(burst->frames_used, 3U);
  ASSERT_TRUE(burst->power_dbm);
  EXPECT_NEAR(*burst->power_dbm, -50.0 + mean_above(), 1e-6);
}

TEST(Burst, HasNoPowerWhereNoFrameStatesIt) {
  auto frames = stated_frames({-50.0F, -60.0F});
  frames[0].power_dbm[1].reset();
  frames[1].power_dbm.clear();
  const auto burst = combine_burst(frames, request_of(vht40()));
  ASSERT_TRUE(burst) << burst.error().message;
  EXPECT_FALSE(burst->power_dbm);
}

TEST(Burst, IsOfTheTransmitterOfItsFrames) {
  auto frames = stated_frames({-50.0F, -60.0F});
  const MacAddress device = *parse_mac_address("02:52:4c:00:00:01");
  for (CsiFrame& frame : frames) {
    frame.transmitter = device;
  }
  const auto burst = combine_burst(frames, request_of(vht40()));
  ASSERT_TRUE(burst) << burst.error().message;
  EXPECT_EQ(burst->transmitter, device);
}

}  // namespace
}  // namespace rayloc::burst_test
