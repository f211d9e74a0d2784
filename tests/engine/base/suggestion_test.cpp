#include "engine/base/suggestion.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace rayloc {
namespace {

const std::vector<std::string> kMaterials{"concrete", "brick", "glass"};

TEST(Suggestion, NamesTheNearest) {
  EXPECT_EQ(closest_name("concret", kMaterials), "concrete");
  EXPECT_EQ(closest_name("galss", {{"glass"}}), std::nullopt);  // two letters of five differ
  EXPECT_EQ(suggestion("bric", kMaterials), " (did you mean 'brick'?)");
}

TEST(Suggestion, ListsAllWhenNothingIsNear) {
  EXPECT_EQ(suggestion("marshmallow", kMaterials), " (there are: concrete, brick, glass)");
  EXPECT_EQ(suggestion("x", {}), "");
  EXPECT_EQ(closest_name(std::string(1000, 'a'), kMaterials), std::nullopt);
}

}  // namespace
}  // namespace rayloc
