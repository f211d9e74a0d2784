#include "daemon/pipeline/person_numbers.h"

#include <cstdint>
#include <optional>
#include <vector>

#include <gmock/gmock.h>

namespace rayloc::person_numbers_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

LocationEstimate person(std::optional<Vec3d> position) {
  LocationEstimate estimate;
  estimate.position = position;
  return estimate;
}

const std::vector<LocationEstimate> kTwo{person(Vec3d{1.0, 0.0, 0.0}),
                                         person(Vec3d{-1.0, 0.5, 0.0})};

TEST(PersonNumbers, FollowTheTrack) {
  EXPECT_THAT(numbers_of(kTwo, {5, 2, Vec3d{0.8, 0.1, 0.0}}), ElementsAre(5, 7));
  EXPECT_THAT(numbers_of(kTwo, {5, 2, Vec3d{-0.9, 0.6, 0.0}}), ElementsAre(7, 5));
}

TEST(PersonNumbers, AreInOrderWithoutATrackedPosition) {
  EXPECT_THAT(numbers_of(kTwo, {3, 1, std::nullopt}), ElementsAre(3, 4));
  const std::vector<LocationEstimate> no_fix{person(std::nullopt), person(std::nullopt)};
  EXPECT_THAT(numbers_of(no_fix, {3, 1, Vec3d{0.0, 0.0, 0.0}}), ElementsAre(3, 4));
  EXPECT_THAT(numbers_of({}, {3, 1, std::nullopt}), IsEmpty());
}

TEST(PersonNumbers, AssignTheTrackNumberToTheVisiblePerson) {
  const std::vector<LocationEstimate> one_hidden{person(std::nullopt), kTwo[1]};
  EXPECT_THAT(numbers_of(one_hidden, {5, 2, Vec3d{0.8, 0.1, 0.0}}), ElementsAre(7, 5));
}

}  // namespace
}  // namespace rayloc::person_numbers_test
