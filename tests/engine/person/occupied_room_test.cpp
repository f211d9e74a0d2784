#include "engine/person/calibrate/occupied_room.h"

#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "engine/observe/alignment.h"
#include "engine/room/preprocess_burst.h"
#include "tests/support/person_in_room.h"

namespace rayloc::occupied_room_test {
namespace {

TEST(OccupiedRoom, IsMeasuredThroughAWalkingPerson) {
  const RoomModel room = test::make_room();
  std::vector<CsiFrame> frames;
  for (unsigned i = 0; i < 60; ++i) {
    const TargetPosition walker{0.9 * std::sin(0.21 * i), 0.7 * std::sin(0.33 * i + 0.5)};
    for (CsiFrame frame : test::frames_past(
             room, {walker}, PersonModel{}.body, {.count = 1, .snr_db = 35.0, .seed = i + 1})) {
      frame.time += from_seconds(0.1 * i);
      frames.push_back(std::move(frame));
    }
  }
  const auto empty = test::frames_past(room, {}, {}, {.count = 20, .snr_db = 35.0, .seed = 99});
  const Aligner aligner(room.grid);
  std::vector<std::string> warnings;
  for (std::size_t ap = 0; ap < room.access_points.size(); ++ap) {
    BurstOptions options;
    options.max_frames = 1024;
    const auto truth = preprocess_burst(room, ap, empty, options, warnings);
    const auto mean = preprocess_burst(room, ap, frames, options, warnings);
    const auto background = receive_background(room, ap, frames, options, warnings);
    ASSERT_TRUE(truth && mean && background);
    const double off_mean = 1.0 - aligner.align(truth->h, mean->h).correlation;
    const double off = 1.0 - aligner.align(truth->h, background->h).correlation;
    std::printf("access point %zu: mean %.2e, background %.2e off\n", ap, off_mean, off);
    // So small a room leaves no frame without a shadow; it is not much worse than the mean.
    EXPECT_LT(off, 1.2 * off_mean);
    EXPECT_LT(off, 0.03);
    EXPECT_LE(background->frames_used, 30U);
  }
}

TEST(OccupiedRoom, NeedsFrames) {
  const RoomModel room = test::make_room();
  std::vector<std::string> warnings;
  EXPECT_FALSE(receive_background(room, 0, {}, {}, warnings));
}

}  // namespace
}  // namespace rayloc::occupied_room_test
