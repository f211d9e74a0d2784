#include "daemon/lab/calibrate/report/parameter_change.h"

#include <gtest/gtest.h>

namespace rayloc::parameter_change_test {
namespace {

constexpr double kWavelength = 0.058;  // [m]: a uniform error over half of it has 8.4 mm

std::string caution(const RoomParameter& parameter) {
  return parameter_changes({parameter}, kWavelength).front().caution;
}

TEST(ParameterChanges, AreSortedByPriorSigmas) {
  const auto changes =
      parameter_changes({{{9.0, 0.0, 0.1}, parse_parameter_id("none"), "1", 0.0},
                         {{0.101, 0.1, 0.001}, parse_parameter_id("little"), "m", 0.01},
                         {{-0.2, 0.0, 0.001}, parse_parameter_id("much"), "rad", 0.1}},
                        kWavelength);
  ASSERT_EQ(changes.size(), 3U);
  EXPECT_EQ(changes[0].parameter.id.of, "much");
  EXPECT_DOUBLE_EQ(changes[0].by, -0.2);
  EXPECT_DOUBLE_EQ(changes[0].prior_sigmas.value(), 2.0);
  EXPECT_EQ(changes[1].parameter.id.of, "little");
  EXPECT_FALSE(changes[2].prior_sigmas);
}

TEST(ParameterChanges, TrustAPosteriorThatIsTighterThanThePrior) {
  EXPECT_EQ(caution({{0.003, 0.0, 0.001}, parse_parameter_id("wall.+x.offset"), "m", 0.01}), "");
}

TEST(ParameterChanges, WarnOfAPosteriorAsWideAsThePrior) {
  EXPECT_EQ(caution({{4.0, 3.9, 0.48}, parse_parameter_id("brick.permittivity"), "1", 0.5}),
            "known no better than before");
}

TEST(ParameterChanges, WarnWhereTheDataBoundNothing) {
  EXPECT_EQ(caution({{4.0, 3.9, 0.0}, parse_parameter_id("brick.permittivity"), "1", 0.5}),
            "not bounded by the data");
}

TEST(ParameterChanges, WarnOfOffsetsKnownToNoHalfWave) {
  EXPECT_EQ(caution({{0.03, 0.0, 0.009}, parse_parameter_id("wall.+x.offset"), "m", 0.05}),
            "several half-wave cycles possible");
  EXPECT_EQ(caution({{0.03, 0.0, 0.008}, parse_parameter_id("wall.+x.offset"), "m", 0.05}), "");
  EXPECT_EQ(caution({{0.03, 0.0, 0.009}, parse_parameter_id("ap1.position.x"), "m", 0.05}), "");
}

TEST(ParameterChanges, WarnOfValuesFarFromThePrior) {
  EXPECT_EQ(caution({{0.031, 0.0, 0.001}, parse_parameter_id("wall.+x.offset"), "m", 0.01}),
            "beyond three sigmas of what was assumed");
}

}  // namespace
}  // namespace rayloc::parameter_change_test
