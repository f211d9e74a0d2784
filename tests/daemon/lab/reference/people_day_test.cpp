// Tests the checks of the day of people on frames of a person in a synthetic room.
#include "daemon/lab/reference/people_day.h"

#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/person_in_room.h"

namespace rayloc::people_day_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Frames of a person at `count` places.
std::vector<std::vector<CsiFrame>> frames_of_people(const RoomModel& room, int count) {
  std::vector<std::vector<CsiFrame>> points;
  for (int i = 0; i < count; ++i) {
    const TargetPosition place{1.0 * std::sin(2.4 * i), 0.7 * std::sin(1.7 * i + 0.5)};
    points.push_back(test::frames_past(
        room, {place}, PersonModel{}.body, {.count = 6, .seed = static_cast<unsigned>(i)}));
  }
  return points;
}

// The reference of a day on which one chain of access point 1 has another phase.
PersonReference rotated_reference(const RoomModel& room, std::size_t chain, double angle) {
  PersonReference reference = test::learn_reference(room);
  std::vector<std::complex<double>>& empty = reference.links[1].empty;
  const std::size_t tones = room.grid.size();
  for (std::size_t k = 0; k < tones; ++k) {
    empty[chain * tones + k] *= std::polar(1.0, angle);
  }
  return reference;
}

TEST(PeopleDay, AcceptsPeopleOfTheSameDay) {
  const RoomModel room = test::make_room();
  const PersonReference reference = test::learn_reference(room);
  for (const int count : {8, 16}) {
    const auto checked = check_people_day(room, reference, frames_of_people(room, count));
    EXPECT_TRUE(checked) << checked.error().message;
  }
}

TEST(PeopleDay, NamesTheRotatedChainAndTheOption) {
  const RoomModel room = test::make_room();
  const auto checked =
      check_people_day(room, rotated_reference(room, 2, -1.8), frames_of_people(room, 16));
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().kind, ErrorKind::kBadInput);
  const std::string& message = checked.error().message;
  EXPECT_THAT(message, HasSubstr("--people-empty"));
  EXPECT_THAT(message,
              HasSubstr(room.access_points[1].id + ": rx chain " +
                        std::to_string(room.access_points[1].rx_chains[2]) + " by "));
  EXPECT_THAT(message, Not(HasSubstr(room.access_points[0].id + ":")));
}

TEST(PeopleDay, ANoisyChainIsNotNamed) {
  RotatedChains chains;
  chains.turn = {1.0, std::polar(1.0, 0.8), std::polar(1.0, 1.4)};
  chains.sigma = {0.01, 0.02, 0.5};
  const auto rotated = find_rotated(chains);
  ASSERT_TRUE(rotated);
  EXPECT_EQ(rotated->row, 1U);
  EXPECT_NEAR(rotated->angle, 0.8, 1e-9);
  chains.sigma[2] = 0.02;
  EXPECT_EQ(find_rotated(chains)->row, 2U) << "the largest rotation";
  chains.sigma = {0.5, 0.5, 0.5};
  EXPECT_FALSE(find_rotated(chains));
}

TEST(PeopleDay, RefusesEchoesAtALimitAtEveryAccessPoint) {
  const RoomModel room = test::make_room();
  PersonReference fitted;
  fitted.links.resize(2);
  fitted.links[0].scale = {0.0, 1.804};
  fitted.links[1].access_point = 1;
  fitted.links[1].scale = {-0.9, 0.0};
  std::vector<PersonPoint> points(2);
  points[0].h = {{1.0}, {1.0}};
  points[1].h = {{1.0}, {}};
  EXPECT_TRUE(check_echo_factors(room, fitted, points));
  fitted.links[1].scale = {0.355, 0.0};
  const auto checked = check_echo_factors(room, fitted, points);
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(checked.error().message, HasSubstr("1.80"));
  EXPECT_THAT(checked.error().message, HasSubstr("--people-empty"));
}

TEST(PeopleDay, AnAccessPointWithoutPeopleDoesNotAcceptTheEchoesOfOthers) {
  const RoomModel room = test::make_room();
  PersonReference fitted;
  fitted.links.resize(2);
  fitted.links[0].scale = {0.0, 1.804};
  fitted.links[1].access_point = 1;
  fitted.links[1].scale = 1.0;  // not fitted
  std::vector<PersonPoint> points(2);
  points[0].h = points[1].h = {{1.0}, {}};
  EXPECT_FALSE(check_echo_factors(room, fitted, points));
  points[1].h[1] = {1.0};
  EXPECT_TRUE(check_echo_factors(room, fitted, points));
}

}  // namespace
}  // namespace rayloc::people_day_test
