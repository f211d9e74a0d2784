#include "engine/track/follow/weighed_access_points.h"

#include <gtest/gtest.h>

namespace rayloc::weighed_access_points_test {
namespace {

RoomObservation of(std::initializer_list<std::size_t> access_points) {
  RoomObservation observation;
  for (const std::size_t ap : access_points) {
    observation.arrays.emplace_back().ap = ap;
  }
  return observation;
}

Timestamp at(double seconds) { return Timestamp(from_seconds(seconds)); }

TEST(WeighedAccessPoints, OneThatWasAbsentForSecondsJoins) {
  WeighedAccessPoints weighed;
  EXPECT_TRUE(weighed.is_joined_by(of({0}), at(1)));
  weighed.note(of({0, 2}), at(1));
  EXPECT_FALSE(weighed.is_joined_by(of({0}), at(2)));
  EXPECT_FALSE(weighed.is_joined_by(of({0, 2}), at(2)));
  EXPECT_TRUE(weighed.is_joined_by(of({0, 1}), at(2)));
  EXPECT_TRUE(weighed.is_joined_by(of({3}), at(2)));
  weighed.note(of({0}), at(5));
  EXPECT_FALSE(weighed.is_joined_by(of({0}), at(7)));
  EXPECT_TRUE(weighed.is_joined_by(of({0, 2}), at(7)));
}

TEST(WeighedAccessPoints, CountsThoseOfTheLastSecond) {
  WeighedAccessPoints weighed;
  EXPECT_EQ(weighed.recent(), 0U);
  weighed.note(of({0, 2}), at(1));
  EXPECT_EQ(weighed.recent(), 2U);
  weighed.note(of({2}), at(2));
  EXPECT_EQ(weighed.recent(), 2U);
  weighed.note(of({2}), at(2.5));
  EXPECT_EQ(weighed.recent(), 1U);
}

}  // namespace
}  // namespace rayloc::weighed_access_points_test
