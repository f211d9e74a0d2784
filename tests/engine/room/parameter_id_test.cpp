#include "engine/room/parameter_id.h"

#include <gtest/gtest.h>

namespace rayloc::parameter_id_test {
namespace {

TEST(ParameterIds, AreReadFromTheNameThatTheyWrite) {
  for (int i = 0; i < static_cast<int>(Quantity::kOther); ++i) {
    const ParameterId id{"wall_west.+x", static_cast<Quantity>(i)};
    EXPECT_NE(to_string(id), id.of) << i << " has no ending";
    EXPECT_EQ(parse_parameter_id(to_string(id)), id) << to_string(id);
  }
}

TEST(ParameterIds, NameAsFilesDo) {
  EXPECT_EQ(to_string({"ap1.core1/core0", Quantity::kPhase}), "ap1.core1/core0.phase");
  EXPECT_EQ(parse_parameter_id("ap1.position.x"), (ParameterId{"ap1", Quantity::kPositionX}));
  EXPECT_EQ(parse_parameter_id("chair.x"), (ParameterId{"chair", Quantity::kTranslationX}));
  EXPECT_EQ(parse_parameter_id("ap1.yaw_offset"), (ParameterId{"ap1", Quantity::kYawOffset}));
}

TEST(ParameterIds, KeepUnknownNames) {
  EXPECT_EQ(parse_parameter_id("roof.colour"), (ParameterId{"roof.colour", Quantity::kOther}));
  EXPECT_EQ(to_string(parse_parameter_id("roof.colour")), "roof.colour");
}

}  // namespace
}  // namespace rayloc::parameter_id_test
