#include "engine/likelihood/box/delay_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "engine/likelihood/observation_model.h"
#include "engine/room/preprocess_burst.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::delay_rows_test {
namespace {

TEST(DelayRows, AreTheBurstAtEveryDelay) {
  ObservedArray observed(2);
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t t = 0; t < ObservedArray::kDelays; ++t) {
      const auto value = static_cast<double>(100 * i + t);
      observed.set(i, t, {value, -value});
    }
  }
  observed.captured = 0.75;
  const DelayRows rows = delay_rows(observed, 10);
  ASSERT_EQ(rows.coordinates(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t t = 0; t < ObservedArray::kDelays; ++t) {
      EXPECT_EQ(rows.re[i][t], static_cast<float>(100 * i + t));
      EXPECT_EQ(rows.im[i][t], -static_cast<float>(100 * i + t));
    }
  }
  EXPECT_FLOAT_EQ(rows.noise, 0.25F * 2.0F / 8.0F);
}

// Frames of the radios: a single one has no difference to another frame.
TEST(DelayRows, NoiseIsWithinAFactorOf1_5) {
  const RoomModel room = test::make_room();
  const RoomAccessPoint& ap = room.access_points[0];
  const ObservationModel model(room.grid, ap.rx_chains.size());
  const std::size_t values = ap.rx_chains.size() * room.grid.size();
  for (const double snr_db : {10.0, 20.0, 30.0, 40.0}) {
    const auto frames = test::frames_at(room, {0.4, -0.5, 1.2}, {1, snr_db, 5});
    std::vector<std::string> warnings;
    const auto burst = preprocess_burst(room, 0, frames, {}, warnings);
    ASSERT_TRUE(burst) << snr_db;
    const DelayRows rows = delay_rows(model.observe(burst->h), values);
    // Share of the noise in the power of the burst, over the coordinates of the basis.
    const double power = std::pow(10.0, -0.1 * snr_db);
    const double truth = power / (1.0 + power) * static_cast<double>(model.dimension()) /
                         static_cast<double>(values);
    EXPECT_LT(static_cast<double>(rows.noise), 1.5 * truth) << snr_db;
    EXPECT_GT(static_cast<double>(rows.noise), truth / 1.5) << snr_db;
  }
}

TEST(DelayRows, NoiseOutsideTheBasisIsAShare) {
  EXPECT_EQ(noise_outside_basis(1.0 + 1e-9, 18, 171), 0.0);
  EXPECT_EQ(noise_outside_basis(0.0, 18, 20), 1.0);
}

}  // namespace
}  // namespace rayloc::delay_rows_test
