// The published method does what it claims: in a room that its own tracer simulated without noise,
// its loss vanishes at the device, a descent begun there stays, and one begun beside it returns.
// The reach of that "beside" is the reason why random starts do not find the device.
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "engine/paper/localizer.h"
#include "tests/support/synthetic_room.h"

namespace rayloc::paper::proof_test {
namespace {

constexpr double kNoiseless = 200.0;  // [dB]
const Vec3d kTruth{0.3, 0.2, 1.2};    // [m]

// Without the term that pulls to the middle of the room and without smoothing: the descent of the
// loss itself, in steps that fit into a wave of 5.8 cm.
LocalizerOptions bare() {
  LocalizerOptions options;
  options.centre_weight = 0.0;
  options.descent.is_smoothed = false;
  options.descent.rate = 2e-4;
  options.descent.iterations = 300;
  return options;
}

class PaperProof : public ::testing::Test {
 protected:
  PaperProof()
      : room_(std::make_shared<const RoomModel>(test::make_room())),
        frames_(test::frames_at(*room_, kTruth, {.snr_db = kNoiseless})) {}

  // From a place [m] beside the device to where the descent ends beside it.
  LocationEstimate from(double x, double y, LocalizerOptions options) const {
    options.start = kTruth + Vec3d{x, y, 0.0};
    return Localizer::create(room_, options)->locate(frames_);
  }
  static double error_of(const LocationEstimate& estimate) {
    return std::hypot(estimate.position->x - kTruth.x, estimate.position->y - kTruth.y);
  }
  // Share of 8 directions from which a start that far away [m] comes back to within 2 mm.
  double share_back(double distance) const {
    constexpr int kDirections = 8;
    int back = 0;
    for (int i = 0; i < kDirections; ++i) {
      const double angle = (i + 0.3) * 2.0 * std::numbers::pi / kDirections;
      back += error_of(from(distance * std::cos(angle), distance * std::sin(angle), bare())) < 2e-3
                  ? 1
                  : 0;
    }
    return static_cast<double>(back) / kDirections;
  }

  std::shared_ptr<const RoomModel> room_;
  std::vector<CsiFrame> frames_;
};

TEST_F(PaperProof, LossIsZeroAtTheDevice) {
  const auto method = Localizer::create(room_, bare());
  EXPECT_LT(method->loss(frames_, kTruth)->value, 1e-6);
  EXPECT_GT(method->loss(frames_, kTruth + Vec3d{0.01, 0.0, 0.0})->value, 1e-4);
}

TEST_F(PaperProof, StaysWhereTheDeviceIs) {
  const LocationEstimate estimate = from(0.0, 0.0, bare());
  EXPECT_LT(error_of(estimate), 1e-3);
  LocalizerOptions still = bare();
  still.descent.iterations = 0;
  EXPECT_LT(from(0.0, 0.0, still).loss, 1e-6);
}

TEST_F(PaperProof, ConvergesFromOneCentimetreButNotFromThree) {
  EXPECT_EQ(share_back(0.01), 1.0);
  EXPECT_LT(share_back(0.03), 0.3);
}

// Along a line through the room the loss has many hollows; the deepest is the device's.
TEST_F(PaperProof, HasManyLocalMinimaAndTheDeepestAtTheDevice) {
  const auto method = Localizer::create(room_, bare());
  double before = 0.0;
  double here = 0.0;
  int hollows = 0;
  for (int i = -1500; i <= 1100; i += 2) {  // [mm] from the device, wall to wall
    const double next = method->loss(frames_, kTruth + Vec3d{1e-3 * i, 0.0, 0.0})->value;
    hollows += i > -1497 && here < before && here < next ? 1 : 0;
    EXPECT_TRUE(i == 0 || next > 1e-5) << i;
    before = here;
    here = next;
  }
  EXPECT_GT(hollows, 50);
}

}  // namespace
}  // namespace rayloc::paper::proof_test
