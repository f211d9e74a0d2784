// Moments that a localizer preprocesses in single precision, beside double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <limits>
#include <memory>
#include <vector>

#include "engine/localize/localizer.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::single_precision_test {
namespace {

const Vec3d kPlace{0.4, -0.5, 1.2};

class SinglePrecision : public ::testing::Test {
 protected:
  static const Localizer& localizer() {
    static const Localizer kMade =
        *Localizer::create(std::make_shared<const RoomModel>(test::make_room()), {});
    return kMade;
  }
  std::vector<CsiFrame> frames(int count) const {
    return test::frames_at(localizer().room(), kPlace, {count, 25.0, 3});
  }
};

void expect_same_moment(const std::vector<CsiFrame>& frames, const Localizer& localizer) {
  ASSERT_TRUE(localizer.has_place_boxes());
  const RoomObservation exact = localizer.receive(frames);
  const RoomObservation single = localizer.receive(frames, Localizer::Precision::kSingle);
  EXPECT_EQ(single.estimate.warnings, exact.estimate.warnings);
  EXPECT_EQ(single.estimate.time, exact.estimate.time);
  EXPECT_EQ(single.estimate.frames_used, exact.estimate.frames_used);
  EXPECT_EQ(single.estimate.antennas_used, exact.estimate.antennas_used);
  ASSERT_EQ(single.arrays.size(), exact.arrays.size());
  const double rounding =
      static_cast<double>(std::numeric_limits<float>::epsilon()) *
      static_cast<double>(ObservedArray::kDelays + localizer.room().grid.size());
  for (std::size_t n = 0; n < exact.arrays.size(); ++n) {
    const ArrayObservation& a = single.arrays[n];
    const ArrayObservation& b = exact.arrays[n];
    EXPECT_EQ(a.ap, b.ap);
    EXPECT_EQ(a.map, b.map);
    ASSERT_EQ(a.h.size(), b.h.size());
    for (std::size_t i = 0; i < a.h.size(); ++i) {
      EXPECT_LT(std::abs(a.h[i] - b.h[i]), 1e-9) << i;
    }
    const ObservedArray& of_a = a.observed.array;
    const ObservedArray& of_b = b.observed.array;
    EXPECT_NEAR(of_a.noise, of_b.noise, 1e-9 * of_b.noise);
    EXPECT_NEAR(of_a.captured, of_b.captured, 2.0 * rounding);
    ASSERT_EQ(of_a.coordinates(), of_b.coordinates());
    for (std::size_t i = 0; i < of_a.coordinates(); ++i) {
      for (std::size_t t = 0; t < ObservedArray::kDelays; ++t) {
        EXPECT_LT(std::abs(of_a.value(i, t) - of_b.value(i, t)), rounding) << i << " " << t;
      }
    }
  }
}

TEST_F(SinglePrecision, IsDoublePrecisionForAnyNumberOfFrames) {
  for (const int count : {1, 2, 5, 40}) {
    SCOPED_TRACE(count);
    expect_same_moment(frames(count), localizer());
    ASSERT_FALSE(localizer().receive(frames(count)).arrays.empty());
  }
}

TEST_F(SinglePrecision, LeavesOutADeadChain) {
  for (const int count : {1, 4}) {
    SCOPED_TRACE(count);
    std::vector<CsiFrame> dead = frames(count);
    for (CsiFrame& frame : dead) {
      const auto row = frame.csi.row(1, 0);
      std::fill(row.begin(), row.end(), std::complex<float>());
    }
    expect_same_moment(dead, localizer());
    const auto received = localizer().receive(dead, Localizer::Precision::kSingle);
    ASSERT_FALSE(received.arrays.empty());
    EXPECT_EQ(received.arrays.front().map->antennas(),
              localizer().room().access_points[0].rx_chains.size() - 1);
  }
}

TEST_F(SinglePrecision, RefusesFramesWithoutATone) {
  std::vector<CsiFrame> other = frames(1);
  for (CsiFrame& frame : other) {
    frame.tone_index.back() = static_cast<std::int16_t>(frame.tone_index.back() + 1);
  }
  expect_same_moment(other, localizer());
  EXPECT_TRUE(localizer().receive(other, Localizer::Precision::kSingle).arrays.empty());
}

}  // namespace
}  // namespace rayloc::single_precision_test
