#include "daemon/site/model/calibration_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>

namespace rayloc::calibration_file_test {
namespace {

CalibrationFile example() {
  CalibrationFile file;
  file.id = "0123456789abcdef";
  file.scene_hash = "fedcba9876543210";
  file.points_hash = "00000000deadbeef";
  file.likelihood_exponent = {1.3, 0.6, 0.0};
  file.sigma_floor = {0.004, 0.01, 0.0};
  CalibratedAccessPoint ap;
  ap.id = "ap1";
  ap.points = 143;
  ap.yaw_offset = {0.0113, 0.0, 0.0059};
  ap.plan_tolerance = {0.022, 0.015, 0.011};
  ap.diffuse = {0.0218, 0.05, 0.0035};
  ap.diffuse_exponent = {1.12, 0.0, 0.22};
  ap.diffuse_decay = {13e-9, 18e-9, 6e-10};
  ap.noise = {7e-4, 2e-3, 0.0};
  ap.gains = {{5.19e9, 312'500.0, {-3, -2, 2, 3}}, {2, 0}, {}, {}};
  for (int i = 0; i < 8; ++i) {
    ap.gains.gain.emplace_back(1.0 / (1 + i), -0.1 * i);
  }
  ap.gains.coupling = {1.0, {0.03, -0.01}, {-0.02, 0.0}, 1.0};
  ap.gain_sigma = {0.01, 0.02};
  ap.element_y = {0.0, -0.0007};
  ap.position_x = {0.004, 0.0, 0.001};
  ap.powers = {{*parse_mac_address("02:52:4c:00:00:01"), -41.3, 2.1},
               {*parse_mac_address("02:52:4c:00:00:0a"), 1.0 / 3.0, 0.5}};
  file.access_points = {ap};
  file.method = "joint";
  file.ray_depth = 3;
  file.transmission = true;
  file.surfaces = {{7, {0.9, -0.1}}};
  file.parameters = {
      {{0.0168, 0.0, 0.0012}, parse_parameter_id("wall \"west\".+x.offset"), "m", 0.015}};
  return file;
}

TEST(CalibrationFile, WithoutADiffuseDecayHasTheDefaultDecay) {
  std::string text = to_toml(example());
  const std::size_t from = text.find("diffuse_decay");
  ASSERT_NE(from, std::string::npos);
  text.erase(from, text.find('\n', from) + 1 - from);
  const auto read = parse_calibration_file(text, "calibration.toml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->access_points.front().diffuse_decay.value, kDiffuseDecay);
}

TEST(CalibrationFile, ReadsBackWrittenFiles) {
  const CalibrationFile written = example();
  const auto read = parse_calibration_file(to_toml(written), "calibration.toml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->id, written.id);
  EXPECT_EQ(read->scene_hash, written.scene_hash);
  EXPECT_EQ(read->points_hash, written.points_hash);
  EXPECT_EQ(read->likelihood_exponent.value, 1.3);
  EXPECT_EQ(read->sigma_floor.value, 0.004);
  ASSERT_EQ(read->access_points.size(), 1U);
  const CalibratedAccessPoint& ap = read->access_points[0];
  EXPECT_EQ(ap.id, "ap1");
  EXPECT_EQ(ap.points, 143U);
  for (const NamedValue& named : calibrated_values()) {
    EXPECT_EQ((ap.*named.value).value, (written.access_points[0].*named.value).value) << named.name;
    EXPECT_EQ((ap.*named.value).sigma, (written.access_points[0].*named.value).sigma) << named.name;
  }
  EXPECT_EQ(ap.gains.grid, written.access_points[0].gains.grid);
  EXPECT_EQ(ap.gains.rx_chains, written.access_points[0].gains.rx_chains);
  EXPECT_EQ(ap.gains.gain, written.access_points[0].gains.gain);  // to the last bit
  EXPECT_EQ(ap.gains.coupling, written.access_points[0].gains.coupling);
  EXPECT_EQ(ap.gain_sigma, written.access_points[0].gain_sigma);
  EXPECT_EQ(ap.element_y, written.access_points[0].element_y);
  ASSERT_EQ(ap.powers.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const TransmitterPower& power = written.access_points[0].powers[i];
    EXPECT_EQ(ap.powers[i].transmitter, power.transmitter);
    EXPECT_EQ(ap.powers[i].offset_db, power.offset_db);
    EXPECT_EQ(ap.powers[i].sigma_db, power.sigma_db);
  }
  EXPECT_EQ(read->method, "joint");
  EXPECT_EQ(read->ray_depth, 3);
  EXPECT_TRUE(read->transmission);
  ASSERT_EQ(read->surfaces.size(), 1U);
  EXPECT_EQ(read->surfaces[0].index, 7U);
  EXPECT_EQ(read->surfaces[0].correction, written.surfaces[0].correction);
  ASSERT_EQ(read->parameters.size(), 1U);
  EXPECT_EQ(read->parameters[0].id, written.parameters[0].id);
  EXPECT_EQ(read->parameters[0].sigma, 0.0012);
}

// Those of before have none.
TEST(CalibrationFile, TakesChainsWithoutCoupling) {
  CalibrationFile written = example();
  written.access_points[0].gains.coupling.clear();
  const std::string text = to_toml(written);
  EXPECT_EQ(text.find("coupling"), std::string::npos);
  const auto read = parse_calibration_file(text, "calibration.toml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->access_points[0].gains.coupling.empty());
}

TEST(CalibrationFile, RefusesACouplingOfSomeChains) {
  std::string text = to_toml(example());
  const std::size_t begin = text.find("coupling = ");
  text.erase(begin, text.find('\n', begin) - begin);
  const auto read = parse_calibration_file(text, "calibration.toml");
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("'coupling' of every chain"), std::string::npos)
      << read.error().message;
}

// Those of before have none either, and those of sites without a transmitter of constant power.
TEST(CalibrationFile, TakesAccessPointsWithoutPowers) {
  CalibrationFile written = example();
  written.access_points[0].powers.clear();
  const std::string text = to_toml(written);
  EXPECT_EQ(text.find("level"), std::string::npos);
  const auto read = parse_calibration_file(text, "calibration.toml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->access_points[0].powers.empty());
}

// The error of the example with that line of its second power replaced; it has to be the only one
// and to name the line.
std::string error_of_second_power(const std::string& line, const std::string& by) {
  std::string text = to_toml(example());
  const std::size_t second = text.find("[[access_point.level]]", text.find("level]]") + 1);
  const std::size_t at = text.find(line, second);
  text.replace(at, text.find('\n', at) - at, by);
  const auto number =
      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  const auto read = parse_calibration_file(text, "calibration.toml");
  if (read) {
    return "none";
  }
  std::string message = read.error().message;
  EXPECT_EQ(message.find("calibration.toml:" + std::to_string(number) + ":"), 0U) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  return message;
}

TEST(CalibrationFile, ReportsTheInvalidKeyOfAPower) {
  using ::testing::HasSubstr;
  EXPECT_THAT(error_of_second_power("transmitter = ", "transmitter = \"kitchen\""),
              HasSubstr("kitchen"));
  EXPECT_THAT(error_of_second_power("transmitter = ", "transmitter = 7"), HasSubstr("transmitter"));
  EXPECT_THAT(error_of_second_power("sigma_db = ", "sigma_db = 0.0"), HasSubstr("sigma_db"));
  EXPECT_THAT(error_of_second_power("sigma_db = ", "sigma_db = -1.0"), HasSubstr("sigma_db"));
  EXPECT_THAT(error_of_second_power("offset_db = ", "offset_db = nan"), HasSubstr("offset_db"));
  EXPECT_THAT(error_of_second_power("offset_db = ", "offset_db = \"much\""),
              HasSubstr("offset_db"));
}

TEST(CalibrationFile, RefusesAPowerThatIsNotWhole) {
  for (const std::string key : {"transmitter", "offset_db", "sigma_db"}) {
    std::string text = to_toml(example());
    const std::size_t at = text.find(key + " = ", text.find("[[access_point.level]]"));
    text.erase(at, text.find('\n', at) - at);
    const auto read = parse_calibration_file(text, "calibration.toml");
    ASSERT_FALSE(read) << key;
    EXPECT_THAT(read.error().message, ::testing::HasSubstr("'" + key + "'"));
    EXPECT_EQ(read.error().message.find('\n'), std::string::npos) << read.error().message;
  }
}

TEST(CalibrationFile, ReportsThePositionOfAnError) {
  std::string text = to_toml(example());
  const std::size_t at = text.find("core = 0");
  text.replace(at, 8, "kore = 0");
  const auto read = parse_calibration_file(text, "calibration.toml");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, ErrorKind::kConfiguration);
  EXPECT_EQ(read.error().message.find("calibration.toml:"), 0U) << read.error().message;
  EXPECT_NE(read.error().message.find("core"), std::string::npos) << read.error().message;
}

// A covariance of none, or of less, has no inverse.
TEST(CalibrationFile, RefusesErrorsOfAModelThatNoneHas) {
  for (const std::string key : {"noise", "diffuse", "plan_tolerance"}) {
    std::string text = to_toml(example());
    const std::size_t at = text.find('{', text.find("\n" + key + " = "));
    text.replace(
        at, text.find(',', at) - at, "{ value = " + std::string(key == "noise" ? "0" : "-1"));
    const auto read = parse_calibration_file(text, "calibration.toml");
    ASSERT_FALSE(read) << key;
    const auto line =
        1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    EXPECT_THAT(read.error().message,
                ::testing::StartsWith("calibration.toml:" + std::to_string(line) + ":"));
    EXPECT_THAT(read.error().message, ::testing::HasSubstr("'value'"));
  }
}

TEST(CalibrationFile, RefusesAnotherFormat) {
  std::string text = to_toml(example());
  text.replace(text.find("format = 2"), 10, "format = 9");
  const auto read = parse_calibration_file(text, "calibration.toml");
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("format 9 is not known"), std::string::npos)
      << read.error().message;
}

TEST(CalibrationFile, RefusesGainsThatAreNotOneATone) {
  CalibrationFile file = example();
  std::string text = to_toml(file);
  text.replace(text.find("[[-3, -2], [2, 3]]"), 18, "[[-3, -2], [2, 4]]");
  const auto read = parse_calibration_file(text, "calibration.toml");
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find("4 pairs for 5 tones"), std::string::npos)
      << read.error().message;
}

}  // namespace
}  // namespace rayloc::calibration_file_test
