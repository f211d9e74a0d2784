#include "engine/track/moved_estimate.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <vector>

namespace rayloc::moved_estimate_test {
namespace {

using std::chrono::milliseconds;

std::vector<CsiFrame> frames_from(int first_ms, int last_ms) {
  std::vector<CsiFrame> frames(2);
  frames[0].time = Timestamp(milliseconds(first_ms));
  frames[1].time = Timestamp(milliseconds(last_ms));
  return frames;
}

FilteredEstimate walker() {
  FilteredEstimate last;
  last.location.time = Timestamp(milliseconds(1000));
  last.location.position = Vec3d{1.0, 2.0, 1.2};
  last.location.covariance = {0.01, 0.002, 0.0, 0.002, 0.02, 0.0, 0.0, 0.0, 0.09};
  last.location.accuracy_m = 0.3;
  last.location.frames_used = 4;
  last.location.hypotheses = {{{1.0, 2.0, 1.2}, last.location.covariance, 0.8},
                              {{3.0, 0.0, 1.2}, last.location.covariance, 0.1}};
  last.state = TrackState::kConfirmed;
  last.velocity = Vec3d{0.5, -1.0, 0.0};
  last.transition = TrackTransition{};
  return last;
}

TEST(MovedEstimate, IsMovedToTheMiddleOfTheFrames) {
  const FilteredEstimate moved = moved_estimate(walker(), frames_from(1030, 1050), 0.25);
  const LocationEstimate& location = moved.location;
  EXPECT_EQ(location.time, Timestamp(milliseconds(1040)));
  EXPECT_EQ(location.capture_start, Timestamp(milliseconds(1030)));
  EXPECT_EQ(location.capture_end, Timestamp(milliseconds(1050)));
  EXPECT_NEAR(location.position->x, 1.02, 1e-12);
  EXPECT_NEAR(location.position->y, 1.96, 1e-12);
  EXPECT_EQ(location.position->z, 1.2);
  EXPECT_NEAR(location.hypotheses[1].position.x, 3.02, 1e-12);
  EXPECT_EQ(location.hypotheses[1].weight, 0.1);
  EXPECT_EQ(location.frames_used, 0U);
  EXPECT_EQ(moved.state, TrackState::kConfirmed);
  EXPECT_FALSE(moved.transition);
  EXPECT_FALSE(moved.predicted);
}

TEST(MovedEstimate, GrowsByTheUncertaintyOfTheVelocity) {
  const LocationEstimate location =
      moved_estimate(walker(), frames_from(1040, 1040), 0.25).location;
  const double variance = 0.25 * 0.04 * 0.04;
  EXPECT_NEAR(location.covariance[0], 0.01 + variance, 1e-12);
  EXPECT_NEAR(location.covariance[4], 0.02 + variance, 1e-12);
  EXPECT_EQ(location.covariance[1], 0.002);
  EXPECT_EQ(location.covariance[8], 0.09);
  EXPECT_NEAR(location.hypotheses[0].covariance[0], 0.01 + variance, 1e-12);
  EXPECT_GT(location.accuracy_m, 0.3);
  EXPECT_LT(location.accuracy_m, 0.31);
}

TEST(MovedEstimate, StaysWithoutAVelocityAndWithoutAPosition) {
  FilteredEstimate resting = walker();
  resting.velocity.reset();
  EXPECT_EQ(moved_estimate(resting, frames_from(1040, 1040), 0.0).location.position,
            resting.location.position);
  FilteredEstimate none = walker();
  none.location.position.reset();
  none.location.reason = "the map is flat";
  const LocationEstimate location = moved_estimate(none, frames_from(1040, 1040), 0.1).location;
  EXPECT_FALSE(location.position);
  EXPECT_EQ(location.reason, none.location.reason);
}

}  // namespace
}  // namespace rayloc::moved_estimate_test
