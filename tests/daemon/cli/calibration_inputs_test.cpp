#include "daemon/cli/calibration_inputs.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace rayloc::cli {
namespace {

const std::string kFolder = RAYLOC_TEST_DATA "/sites/meeting_room";

Site bundled_site() {
  auto site = load_site(kFolder);
  EXPECT_TRUE(site);
  return *std::move(site);
}

class CalibrationInputsTest : public testing::Test {
 protected:
  void SetUp() override {
    points_ = std::filesystem::path(testing::TempDir()) /
              (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".csv");
  }
  void TearDown() override { std::filesystem::remove(points_); }

  // The error of reading ap1's recording with these points.
  std::string error_with(const std::string& rows, const Site& site = bundled_site()) const {
    std::ofstream(points_) << rows;
    const auto inputs =
        read_calibration_inputs(site, {{"ap1", kFolder + "/calibration-ap1.pcap.gz"}}, points_);
    return inputs ? "none" : inputs.error().message;
  }

  std::filesystem::path points_;
};

testing::AssertionResult says(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos
             ? testing::AssertionSuccess()
             : testing::AssertionFailure() << "'" << message << "' does not say '" << part << "'";
}

constexpr const char* kRightRow = "1718000125.3680,1718000125.8703,-1.5400,-1.1000,1.2000\n";

TEST_F(CalibrationInputsTest, ReadsARightPoint) {
  EXPECT_EQ(error_with(std::string("t_start,t_end,x,y,z\n") + kRightRow), "none");
}

TEST_F(CalibrationInputsTest, FindsColumnsByTheirNames) {
  EXPECT_EQ(error_with("z,y,x,t_end,t_start\n"
                       "1.2,-1.1,-1.54,1718000125.8703,1718000125.3680\n"),
            "none");
}

TEST_F(CalibrationInputsTest, NamesTheRowOutsideOfTheRoom) {
  const auto message = error_with(std::string("t_start,t_end,x,y,z\n") + kRightRow +
                                  "1718000135.3,1718000135.8,-1.1,7.0,1.2\n");
  EXPECT_TRUE(says(message, ".csv:3: "));
  EXPECT_TRUE(says(message, "outside of the room; points are in metres"));
}

TEST_F(CalibrationInputsTest, SuspectsExchangedColumnsWhereThoseWouldFit) {
  const auto message = error_with(std::string("t_start,t_end,y,x,z\n") + kRightRow);
  EXPECT_TRUE(says(message, ".csv:2: "));
  EXPECT_TRUE(says(message, "are the columns exchanged?"));
}

TEST_F(CalibrationInputsTest, RecognisesATimeAmongTheCoordinates) {
  const auto message = error_with(std::string("x,t_end,t_start,y,z\n") + kRightRow);
  EXPECT_TRUE(says(message, ".csv:2: "));
  EXPECT_TRUE(says(message, "looks like a time"));
}

TEST_F(CalibrationInputsTest, RefusesARecordingThatHeardOnlyFixedTransmitters) {
  Site site = bundled_site();
  for (SiteTransmitter& transmitter : site.transmitters) {
    transmitter.role = TransmitterRole::kFixed;
  }
  const auto message = error_with(std::string("t_start,t_end,x,y,z\n") + kRightRow, site);
  EXPECT_TRUE(says(message, "no CSI frame of a device for access point 'ap1', only "));
  EXPECT_TRUE(says(message, "frames of fixed transmitters"));
}

TEST_F(CalibrationInputsTest, NamesTheAccessPointThatHeardNothingAtThatTime) {
  const auto message =
      error_with("t_start,t_end,x,y,z\n1600000000.0,1600000000.5,-1.54,-1.1,1.2\n");
  EXPECT_TRUE(says(message, "access point 'ap1' heard the device from 1718000"));
  EXPECT_TRUE(says(message, "from 1600000000.000 to 1600000000.500"));
}

// A checkpoint of the one must not be gone on from with the other.
TEST_F(CalibrationInputsTest, TellsExchangedRecordingsApart) {
  std::ofstream(points_) << "t_start,t_end,x,y,z\n" << kRightRow;
  const auto content = [&](const std::string& first, const std::string& second) {
    const auto file = [](const std::string& ap) {
      return kFolder + "/calibration-" + ap + ".pcap.gz";
    };
    const auto inputs = read_calibration_inputs(
        bundled_site(), {{"ap1", file(first)}, {"ap2", file(second)}}, points_);
    return inputs ? inputs->content : inputs.error().message;
  };
  EXPECT_EQ(content("ap1", "ap2"), content("ap1", "ap2"));
  EXPECT_NE(content("ap1", "ap2"), content("ap2", "ap1"));
}

}  // namespace
}  // namespace rayloc::cli
