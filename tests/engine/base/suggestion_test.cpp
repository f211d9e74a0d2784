#include "engine/base/suggestion.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace rayloc::suggestion_test {
namespace {

TEST(ClosestName, FindsTypingErrorsAndAbbreviations) {
  constexpr std::array<std::string_view, 4> kNames = {
      "half_wave_dipole", "dipole", "isotropic", "yaw_deg"};
  EXPECT_EQ(closest_name("dipol", kNames), "dipole");
  EXPECT_EQ(closest_name("dipoel", kNames), "dipole");
  EXPECT_EQ(closest_name("Half-Wave-Dipole", kNames), "half_wave_dipole");
  EXPECT_EQ(closest_name("halfwave", kNames), "half_wave_dipole");
  EXPECT_EQ(closest_name("yaw", kNames), "yaw_deg");
  EXPECT_EQ(closest_name("azimuth", kNames), "");
  EXPECT_EQ(closest_name("", kNames), "");
  EXPECT_EQ(closest_name(std::string(100'000, 'd'), kNames), "");
}

TEST(ClosestName, DoesNotGuessBetweenTwo) {
  constexpr std::array<std::string_view, 2> kNames = {"nexmon-v1", "nexmon-v2"};
  EXPECT_EQ(closest_name("nexmo", std::span(kNames).first(0)), "");
  EXPECT_EQ(suggestion("tcpdump", kNames), "; there are: nexmon-v1, nexmon-v2");
}

TEST(Suggestion, ListsAllWhenNothingIsNear) {
  const std::vector<std::string> materials{"concrete", "brick", "glass"};
  EXPECT_EQ(suggestion("bric", materials), "; did you mean 'brick'?");
  EXPECT_EQ(suggestion("marshmallow", materials), "; there are: concrete, brick, glass");
  EXPECT_EQ(suggestion("x", std::vector<std::string>()), "");
}

}  // namespace
}  // namespace rayloc::suggestion_test
