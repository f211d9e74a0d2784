#include "engine/person/people.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/person_in_room.h"

namespace rayloc::people_test {
namespace {

double distance(const LocationEstimate& estimate, const TargetPosition& truth) {
  return std::hypot(estimate.position->x - truth.x, estimate.position->y - truth.y);
}

// Both places, in whichever order.
double worse_error(const std::vector<LocationEstimate>& found,
                   const TargetPosition& one,
                   const TargetPosition& other) {
  const double straight = std::max(distance(found[0], one), distance(found[1], other));
  const double crossed = std::max(distance(found[0], other), distance(found[1], one));
  return std::min(straight, crossed);
}

// Clear of the transmitter, in pairs at least 0.7 m apart.
struct Pair {
  TargetPosition one;
  TargetPosition other;
};
const std::vector<Pair> kPairs = {{{-0.95, -0.55}, {0.05, 0.35}},
                                  {{-0.4, 0.7}, {0.5, -0.1}},
                                  {{-0.9, 0.4}, {0.1, -0.5}},
                                  {{0.45, 0.7}, {-0.45, -0.1}},
                                  {{-0.95, 0.0}, {0.0, 0.75}},
                                  {{0.5, 0.35}, {-0.4, -0.55}}};

class PeopleTest : public ::testing::Test {
 protected:
  static const std::shared_ptr<const RoomModel>& room() {
    static const auto kRoom = std::make_shared<const RoomModel>(test::make_room());
    return kRoom;
  }
  static PersonLocalizer make(std::optional<double> second_person) {
    PersonReference reference = test::learn_reference(*room());
    reference.person.diffuse = 0.03;  // as fitted to people at known places of recordings
    reference.person.noise = 1e-4;
    reference.person.second_person = second_person;
    return *PersonLocalizer::create(room(), std::move(reference), {});
  }
  static const PersonLocalizer& localizer() {
    static const PersonLocalizer kLocalizer = make(12.0);
    return kLocalizer;
  }
  static std::vector<CsiFrame> frames(const std::vector<TargetPosition>& places, unsigned seed) {
    return test::frames_past(*room(), places, PersonModel{}.body, {.count = 8, .seed = seed});
  }
};

TEST_F(PeopleTest, TwoPeopleAreSeparated) {
  int two = 0;
  int placed = 0;
  int near = 0;
  unsigned seed = 1;
  for (const Pair& pair : kPairs) {
    const auto found = locate_people(localizer(), frames({pair.one, pair.other}, seed++));
    two += found.size() == 2 ? 1 : 0;
    if (found.size() == 2 && found[0].position && found[1].position) {
      ++placed;
      near += worse_error(found, pair.one, pair.other) < 0.35 ? 1 : 0;
    }
  }
  std::printf("two people: seen in %d of %zu, placed in %d, both within 0.35 m in %d\n",
              two,
              kPairs.size(),
              placed,
              near);
  EXPECT_GE(two, 4);
  EXPECT_GE(near, 3);
}

TEST_F(PeopleTest, OneIsLocatedAsByThePersonLocalizer) {
  unsigned seed = 1;
  for (const Pair& pair : kPairs) {
    const auto received = frames({pair.one}, seed++);
    const auto found = locate_people(localizer(), received);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].position, localizer().locate(received).position);
  }
}

TEST_F(PeopleTest, AnEmptyRoomGivesOneEstimateWithoutAPosition) {
  const auto found = locate_people(localizer(), frames({}, 1));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_FALSE(found[0].position);
  EXPECT_NE(found[0].reason.find("no person"), std::string::npos);
  ASSERT_EQ(locate_people(localizer(), {}).size(), 1U);
}

TEST_F(PeopleTest, WithoutKnownPlacesOnlyOnePersonIsSought) {
  const PersonLocalizer unknown = make(std::nullopt);
  const auto received = frames({kPairs[0].one, kPairs[0].other}, 1);
  EXPECT_EQ(locate_people(unknown, received).size(), 1U);
}

TEST_F(PeopleTest, OneAccessPointIsNotEnough) {
  auto received = frames({kPairs[0].one, kPairs[0].other}, 1);
  std::erase_if(received, [](const CsiFrame& frame) { return frame.access_point != 0; });
  EXPECT_EQ(locate_people(localizer(), received).size(), 1U);
}

TEST_F(PeopleTest, TheSecondPersonAvoidsTheCellOfTheFirst) {
  const auto observation = localizer().receive(frames({kPairs[0].one, kPairs[0].other}, 1));
  const double likelihood_exponent = localizer().reference().person.likelihood_exponent;
  const PersonMap alone = localizer().map(observation, likelihood_exponent);
  const std::array others = {alone.places.front()};
  const PersonMap beside =
      localizer().map(observation, likelihood_exponent, {others, std::nullopt});
  EXPECT_LT(beside.log_likelihood[others[0].cell], -1e3);
  EXPECT_GT(beside.best_log_likelihood, alone.best_log_likelihood);
  const PersonMap about = localizer().map(observation, likelihood_exponent, {{}, others[0]});
  EXPECT_EQ(about.places.front().cell, others[0].cell);
  EXPECT_EQ(about.places.front().sample, others[0].sample);
}

}  // namespace
}  // namespace rayloc::people_test
