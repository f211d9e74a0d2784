// Tests the learning of the empty room on frames of a synthetic room.
#include "daemon/lab/reference/learn_reference.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/synthetic_room.h"

namespace rayloc::learn_reference_test {
namespace {

using ::testing::HasSubstr;

const MacAddress kPlug = *parse_mac_address("02:52:4c:00:00:09");
constexpr Vec3d kPlace{1.2, -0.8, 1.2};

std::vector<CsiFrame> frames_from(const Vec3d& place, Duration begin = {}) {
  auto frames = test::frames_at(test::make_room(), place, {.count = 20, .snr_db = 35.0});
  for (CsiFrame& frame : frames) {
    frame.transmitter = kPlug;
    frame.time += begin;
  }
  return frames;
}

ReferenceInputs empty_room() {
  ReferenceInputs inputs;
  inputs.room = test::make_room();
  inputs.room.calibration_id = "0123456789abcdef";
  SiteTransmitter plug;
  plug.role = TransmitterRole::kFixed;
  plug.mac = kPlug;
  plug.position = kPlace;
  inputs.site.transmitters = {plug};
  inputs.site.person = SitePerson{};
  inputs.site.person->radius = 0.18;
  inputs.empty[kPlug] = frames_from(kPlace);
  return inputs;
}

// The same with frames of another place in the second half of the recording.
ReferenceInputs changing_room() {
  ReferenceInputs inputs = empty_room();
  std::vector<CsiFrame>& frames = inputs.empty[kPlug];
  const auto later = frames_from({-0.5, 0.4, 1.2}, std::chrono::seconds(1));
  frames.insert(frames.end(), later.begin(), later.end());
  std::stable_sort(frames.begin(), frames.end(), [](const CsiFrame& a, const CsiFrame& b) {
    return std::pair(a.access_point, a.time) < std::pair(b.access_point, b.time);
  });
  return inputs;
}

Error error_of(const ReferenceInputs& inputs) {
  const auto learned = learn_reference(inputs, {});
  EXPECT_FALSE(learned);
  return learned ? Error{} : learned.error();
}

TEST(LearnReference, LearnsTheLinksOfTheEmptyRoom) {
  std::vector<std::string> stages;
  Observer observer;
  observer.on_progress = [&](double share, const std::string& stage) {
    EXPECT_TRUE(share >= 0.0 && share <= 1.0) << share;
    stages.push_back(stage);
  };
  const auto learned = learn_reference(empty_room(), observer);
  ASSERT_TRUE(learned) << learned.error().message;
  ASSERT_EQ(learned->references.size(), 1U);
  const PersonReference& reference = learned->references.front();
  EXPECT_EQ(reference.mac, kPlug);
  EXPECT_EQ(reference.links.size(), 3U);
  EXPECT_EQ(reference.id.size(), 16U);
  EXPECT_EQ(reference.person.body.semi_axes[0], 0.18) << "as the site states";
  const Vec3d moved = reference.transmitter.position - kPlace;
  EXPECT_LT(std::hypot(moved.x, moved.y), 0.01);
  EXPECT_EQ(learned->points, 0U);
  EXPECT_TRUE(learned->changes.empty());
  EXPECT_TRUE(learned->refused.empty());
  EXPECT_EQ(learned->room.calibration_id, "0123456789abcdef");
  EXPECT_THAT(stages, ::testing::ElementsAre("empty room"));
}

TEST(LearnReference, IsNamedByItsContent) {
  const auto first = learn_reference(empty_room(), {});
  const auto again = learn_reference(empty_room(), {});
  ReferenceInputs other = empty_room();
  other.room.calibration_id = "fedcba9876543210";
  const auto changed = learn_reference(other, {});
  ASSERT_TRUE(first && again && changed);
  EXPECT_EQ(first->references[0].id, again->references[0].id);
  EXPECT_NE(first->references[0].id, changed->references[0].id);
}

TEST(LearnReference, LeavesOutAnAccessPointWithoutFrames) {
  ReferenceInputs inputs = empty_room();
  std::vector<CsiFrame>& frames = inputs.empty[kPlug];
  frames.erase(std::remove_if(frames.begin(),
                              frames.end(),
                              [](const CsiFrame& frame) { return frame.access_point == 1; }),
               frames.end());
  const auto learned = learn_reference(inputs, {});
  ASSERT_TRUE(learned) << learned.error().message;
  EXPECT_EQ(learned->references[0].links.size(), 2U);
  ASSERT_EQ(learned->refused.size(), 1U);
  EXPECT_EQ(learned->refused[0].what, inputs.room.access_points[1].id);
}

TEST(LearnReference, RefusesARoomThatChanges) {
  const Error error = error_of(changing_room());
  EXPECT_EQ(error.kind, ErrorKind::kBadInput);
  EXPECT_THAT(error.message, HasSubstr("--occupied"));
}

TEST(LearnReference, RefusesAnAccessPointWithoutCalibration) {
  ReferenceInputs inputs = empty_room();
  inputs.room.access_points[2].gains = {};
  const Error error = error_of(inputs);
  EXPECT_EQ(error.kind, ErrorKind::kConfiguration);
  EXPECT_THAT(error.message,
              HasSubstr("access point " + inputs.room.access_points[2].id + " has no chain gains"));
}

TEST(LearnReference, RefusesPointsOfAnotherTime) {
  ReferenceInputs inputs = empty_room();
  inputs.people = inputs.empty;
  inputs.points_file = "places.csv";
  SurveyPoint point;
  point.t_start = Timestamp(std::chrono::hours(1));
  point.t_end = point.t_start + std::chrono::seconds(1);
  inputs.points = {point};
  const Error error = error_of(inputs);
  EXPECT_EQ(error.kind, ErrorKind::kBadInput);
  EXPECT_THAT(error.message, HasSubstr("--people: received 02:52:4c:00:00:09"));
  EXPECT_THAT(error.message, HasSubstr("places.csv"));
}

TEST(LearnReference, NeedsATransmitterOfBothDays) {
  ReferenceInputs inputs = empty_room();
  inputs.people_empty[*parse_mac_address("02:52:4c:00:00:0a")] = {};
  EXPECT_EQ(error_of(inputs).kind, ErrorKind::kBadInput);
}

}  // namespace
}  // namespace rayloc::learn_reference_test
