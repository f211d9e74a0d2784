#include "engine/em/antenna_gain_table.h"
#include "engine/base/constants.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rayloc::antenna_gain_table_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double kPi = std::numbers::pi;

constexpr const char* kSmall = R"(# Four sides, no two alike.
theta\phi,    0,   90,  180,  270

        0, -3.0, -3.0, -3.0, -3.0
       90,  2.5, -1.0, -9.5,  0.5
      180, -4.0, -4.0, -4.0, -4.0
)";

AntennaGainTable parsed(const std::string& text) {
  auto table = AntennaGainTable::parse(text, "beam.csv");
  EXPECT_TRUE(table) << table.error().message;
  return *std::move(table);
}

// Samples of `gain`(theta, phi), every `step` degrees from `first_phi` degrees on.
template <typename F>
std::string sampled(F gain, int step, int first_phi) {
  std::string text = "theta\\phi";
  for (int phi = first_phi; phi < first_phi + 360; phi += step) {
    text += "," + std::to_string(phi);
  }
  for (int theta = 0; theta <= 180; theta += step) {
    text += "\n" + std::to_string(theta);
    for (int phi = first_phi; phi < first_phi + 360; phi += step) {
      text += "," + std::to_string(gain(theta * kDegree, phi * kDegree));
    }
  }
  return text;
}

// 3 dB + 5 dB x - 2 dB y z for the direction (x, y, z): smooth on the sphere.
double smooth_gain(double theta, double phi) {
  return 3.0 + 5.0 * std::sin(theta) * std::cos(phi) -
         2.0 * std::sin(theta) * std::sin(phi) * std::cos(theta);
}

TEST(AntennaGainTable, HasItsSamples) {
  for (const std::string& text :
       {std::string(kSmall), "\xef\xbb\xbf" + std::string(kSmall), std::string(kSmall) + "\n\n"}) {
    const AntennaGainTable table = parsed(text);
    EXPECT_NEAR(table.at(kPi / 2, 0.0).dbi, 2.5, 1e-12);
    EXPECT_NEAR(table.at(kPi / 2, kPi / 2).dbi, -1.0, 1e-12);
    EXPECT_NEAR(table.at(kPi / 2, -kPi).dbi, -9.5, 1e-12);
    EXPECT_NEAR(table.at(kPi / 2, kPi).dbi, -9.5, 1e-12);
    EXPECT_NEAR(table.at(kPi / 2, -kPi / 2).dbi, 0.5, 1e-12);
    EXPECT_NEAR(table.at(kPi / 2, 1.5 * kPi).dbi, 0.5, 1e-12);
    EXPECT_NEAR(table.at(0.0, 1.0).dbi, -3.0, 1e-12);
    EXPECT_NEAR(table.at(kPi, 1.0).dbi, -4.0, 1e-12);
  }
}

// As a spreadsheet with decimal commas writes it, in quotes or without.
TEST(Field, GainTableOfASpreadsheetIsThatOfAScript) {
  const AntennaGainTable table = parsed(
      "\"theta\\phi\";\"0\";90;180;270\r\n0;-3,0;-3;-3;-3\r\n90;\"2,5\";-1;-9,5;0,5\r\n"
      "180;-4;-4;-4;-4\r\n");
  EXPECT_NEAR(table.at(kPi / 2, 0.0).dbi, 2.5, 1e-12);
  EXPECT_NEAR(table.at(kPi / 2, -kPi).dbi, -9.5, 1e-12);
}

TEST(AntennaGainTable, ReadsLinesOfWindows) {
  std::string text = kSmall;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) {
    text.insert(at, "\r");
  }
  EXPECT_NEAR(parsed(text).at(kPi / 2, kPi / 2).dbi, -1.0, 1e-12);
}

// The error of the spline falls with the cube of the step or faster.
TEST(AntennaGainTable, FollowsASmoothGainBetweenItsSamples) {
  for (const int first_phi : {0, -180, 90}) {
    const AntennaGainTable table = parsed(sampled(smooth_gain, 5, first_phi));
    for (int i = 0; i <= 83; ++i) {
      for (int k = -41; k <= 41; ++k) {
        const double theta = kPi * i / 83.0;
        const double phi = 0.171 * k;  // more than once around
        EXPECT_NEAR(table.at(theta, phi).dbi, smooth_gain(theta, phi), 2e-3)
            << theta << " " << phi << " from " << first_phi;
      }
    }
  }
}

// Gain and derivatives have no step where one cell ends, nor at phi = +-pi and the first column.
TEST(AntennaGainTable, IsContinuousWithItsDerivatives) {
  const AntennaGainTable table = parsed(kSmall);
  constexpr double kStep = 1e-9;
  const auto expect_no_step = [&](double theta, double phi, double dtheta, double dphi) {
    const AntennaGainTable::Gain before = table.at(theta - dtheta, phi - dphi);
    const AntennaGainTable::Gain after = table.at(theta + dtheta, phi + dphi);
    EXPECT_NEAR(before.dbi, after.dbi, 1e-6) << theta << " " << phi;
    EXPECT_NEAR(before.by_theta, after.by_theta, 1e-6) << theta << " " << phi;
    EXPECT_NEAR(before.by_phi, after.by_phi, 1e-6) << theta << " " << phi;
  };
  for (const double other : {0.1, 0.9, 1.8, 2.9}) {
    for (const double edge : {-kPi, -kPi / 2, 0.0, kPi / 2, kPi}) {
      expect_no_step(other, edge, 0.0, kStep);
    }
    expect_no_step(kPi / 2, other, kStep, 0.0);
  }
  // Over the pole: straight on means phi + pi, and theta falls again.
  const AntennaGainTable::Gain here = table.at(kStep, 0.3);
  const AntennaGainTable::Gain there = table.at(kStep, 0.3 + kPi);
  EXPECT_NEAR(here.dbi, there.dbi, 1e-6);
  EXPECT_NEAR(here.by_theta, -there.by_theta, 1e-6);
  EXPECT_GT(std::abs(here.by_theta), 0.1);
}

TEST(AntennaGainTable, DerivativesMatchCentralDifferences) {
  const AntennaGainTable table = parsed(kSmall);
  constexpr double kStep = 1e-6;
  for (const double theta : {1e-3, 0.4, 1.5, 1.6, 3.0}) {
    for (const double phi : {-3.0, -1.6, 0.2, 1.5, 3.1}) {
      const AntennaGainTable::Gain gain = table.at(theta, phi);
      const double by_theta =
          (table.at(theta + kStep, phi).dbi - table.at(theta - kStep, phi).dbi) / (2.0 * kStep);
      const double by_phi =
          (table.at(theta, phi + kStep).dbi - table.at(theta, phi - kStep).dbi) / (2.0 * kStep);
      EXPECT_NEAR(gain.by_theta, by_theta, 1e-6) << theta << " " << phi;
      EXPECT_NEAR(gain.by_phi, by_phi, 1e-6) << theta << " " << phi;
    }
  }
}

struct Case {
  const char* name;
  const char* text;
  const char* begin;
  const char* hint;
};

class AntennaGainTableError : public ::testing::TestWithParam<Case> {};

TEST_P(AntennaGainTableError, ReportsTheLineAndTheRemedy) {
  const auto table = AntennaGainTable::parse(GetParam().text, "beam.csv");
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().kind, ErrorKind::kConfiguration);
  EXPECT_THAT(table.error().message, StartsWith(GetParam().begin));
  EXPECT_THAT(table.error().message, HasSubstr(GetParam().hint));
}

const auto kCases = std::to_array<Case>({
    {"Empty", "# nothing\n\n", "beam.csv:1: the table is empty", "theta\\phi,0,90"},
    {"Text", "t,0,90,180,east\n", "beam.csv:1: cell 5 is \"east\"", "write a number"},
    {"EmptyCell",
     "t,0,90,180,270\n0,1,2,,4\n90,1,2,3,4\n180,1,2,3,4\n",
     "beam.csv:2: cell 4 is \"\"",
     "write a number"},
    {"Infinite",
     "t,0,90,180,270\n0,1,2,3,-inf\n90,1,2,3,4\n180,1,2,3,4\n",
     "beam.csv:2: cell 5 is \"-inf\"",
     "write a number"},
    {"Decimals",
     "t,0,90,180,270\n0,1,2,3,4\n90,1,2,3,999\n180,1,2,3,4\n",
     "beam.csv:3: a gain of 999 dBi",
     "from -200 to 60"},
    {"RepeatedColumn",
     "t,0,90,180,270,360\n",
     "beam.csv:1: the last column repeats the first",
     "leave it out"},
    {"OddColumns", "t,0,120,240\n", "beam.csv:1: 3 columns of phi", "an even number"},
    {"FewColumns", "t,0,180\n", "beam.csv:1: 2 columns of phi", "4 or more"},
    {"UnevenPhi",
     "\nt,0,90,170,270\n",
     "beam.csv:2: phi is 170 degrees; 4 values once around are 90 degrees apart",
     "this one is 180"},
    {"HalfCircle",
     "t,0,45,90,135\n",
     "beam.csv:1: phi is 45 degrees; 4 values once around are 90 degrees apart",
     "this one is 90"},
    {"FewLines",
     "t,0,90,180,270\n0,1,2,3,4\n180,1,2,3,4\n",
     "beam.csv:3: 2 lines of theta",
     "at least 3"},
    {"ShortLine",
     "t,0,90,180,270\n0,1,2,3,4\n90,1,2,3\n180,1,2,3,4\n",
     "beam.csv:3: 4 cells",
     "an angle and 4 gains"},
    {"UnevenTheta",
     "t,0,90,180,270\n0,1,2,3,4\n80,1,2,3,4\n180,1,2,3,4\n",
     "beam.csv:3: theta is 80 degrees; 3 values from 0 to 180 are 90 degrees apart",
     "this one is 90"},
    {"Elevation",
     "t,0,90,180,270\n-90,1,2,3,4\n0,1,2,3,4\n90,1,2,3,4\n",
     "beam.csv:2: theta is -90 degrees",
     "this one is 0"},
});

INSTANTIATE_TEST_SUITE_P(All,
                         AntennaGainTableError,
                         ::testing::ValuesIn(kCases),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace rayloc::antenna_gain_table_test
