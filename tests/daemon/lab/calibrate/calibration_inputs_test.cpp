#include "daemon/lab/calibrate/calibration_inputs.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "capture/record/pcap_recorder.h"
#include "tests/support/test_paths.h"
#include "tests/support/wire_writer.h"

namespace rayloc::calibration_inputs_test {
namespace {

const std::string kFolder = test::data_path("/sites/meeting_room");

Site bundled_site() {
  auto site = load_site(kFolder);
  EXPECT_TRUE(site);
  return *std::move(site);
}

class CalibrationInputsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    points_ =
        std::filesystem::path(::testing::TempDir()) /
        (std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + ".csv");
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

::testing::AssertionResult contains(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos
             ? ::testing::AssertionSuccess()
             : ::testing::AssertionFailure() << "'" << message << "' does not say '" << part << "'";
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
  EXPECT_TRUE(contains(message, ".csv:3: "));
  EXPECT_TRUE(contains(message, "outside of the room; points are in metres"));
}

TEST_F(CalibrationInputsTest, SuspectsExchangedColumnsWhereThoseWouldFit) {
  const auto message = error_with(std::string("t_start,t_end,y,x,z\n") + kRightRow);
  EXPECT_TRUE(contains(message, ".csv:2: "));
  EXPECT_TRUE(contains(message, "are the columns exchanged?"));
}

class FieldSurvey : public CalibrationInputsTest {};

TEST_F(FieldSurvey, PointsInMillimetresAreNamedAsSuch) {
  const auto message =
      error_with("t_start,t_end,x,y,z\n1718000125.3680,1718000125.8703,-1540.0,-1100.0,1200.0\n");
  EXPECT_TRUE(contains(message, ".csv:2: "));
  EXPECT_TRUE(contains(message, "in millimetres all points lie inside: write metres"));
}

TEST_F(CalibrationInputsTest, RecognisesATimeAmongTheCoordinates) {
  const auto message = error_with(std::string("x,t_end,t_start,y,z\n") + kRightRow);
  EXPECT_TRUE(contains(message, ".csv:2: "));
  EXPECT_TRUE(contains(message, "looks like a time"));
}

// Rows written by hand: the second was copied, and its times never changed.
TEST_F(CalibrationInputsTest, NamesTwoRowsOfOneTime) {
  const auto message = error_with(std::string("t_start,t_end,x,y,z\n") + kRightRow +
                                  "1718000125.6,1718000126.1,-1.1,-1.1,1.2\n");
  EXPECT_TRUE(contains(message, ".csv:3: from 1718000125.600 to 1718000126.100 "));
  EXPECT_TRUE(contains(message, "in the time of row 2 (1718000125.368 to 1718000125.870)"));
}

TEST_F(CalibrationInputsTest, ReadsRowsThatFollowEachOtherAtOnce) {
  EXPECT_EQ(error_with(std::string("t_start,t_end,x,y,z\n") + kRightRow +
                       "1718000125.8603,1718000126.1,-1.1,-1.1,1.2\n"),
            "none");
}

TEST_F(CalibrationInputsTest, RefusesARecordingOfFixedTransmittersOnly) {
  Site site = bundled_site();
  for (SiteTransmitter& transmitter : site.transmitters) {
    transmitter.role = TransmitterRole::kFixed;
  }
  const auto message = error_with(std::string("t_start,t_end,x,y,z\n") + kRightRow, site);
  EXPECT_TRUE(contains(message, "access point 'ap1' received no device, only "));
  EXPECT_TRUE(contains(message, "frames of fixed transmitters"));
}

TEST_F(CalibrationInputsTest, ReportsAnAccessPointWithoutFramesAtThatTime) {
  const auto message =
      error_with("t_start,t_end,x,y,z\n1600000000.0,1600000000.5,-1.54,-1.1,1.2\n");
  EXPECT_TRUE(
      contains(message, "access point 'ap1' received the device 02:52:4c:00:00:01 from 1718000"));
  EXPECT_TRUE(contains(message, "from 1600000000.000 to 1600000000.500"));
}

TEST_F(CalibrationInputsTest, TakesTheBoundsOfTheSceneWhereTheSiteStatesNone) {
  Site site = bundled_site();
  RoomModel room;
  room.bounds_min = site.bounds_min;
  room.bounds_max = site.bounds_max;
  site.has_bounds = false;
  const std::string far = "t_start,t_end,x,y,z\n1718000125.3,1718000125.8,-1.1,7.0,1.2\n";
  EXPECT_FALSE(contains(error_with(far, site), "outside of the room"));
  EXPECT_TRUE(contains(error_with(far, with_bounds(site, room)), "outside of the room"));
}

TEST_F(CalibrationInputsTest, ReportsAnAccessPointThatReceivedOnlyUnlistedDevices) {
  Site site = bundled_site();
  for (SiteTransmitter& transmitter : site.transmitters) {
    transmitter.mac.octets[5] += 0x40;
  }
  const auto message = error_with(std::string("t_start,t_end,x,y,z\n") + kRightRow, site);
  EXPECT_TRUE(
      contains(message, "access point 'ap1' received no frame of a device that site.toml lists"));
  EXPECT_TRUE(contains(message, "only of others (02:52:4c:00:00:01)"));
}

// Two points, at which the device sends three frames each and a neighbour's phone ten at the
// second.
class SurveyOfTwoPoints : public CalibrationInputsTest {
 protected:
  static constexpr std::uint64_t kDevice = 0x02524c000001;  // of the site
  static constexpr std::uint64_t kStranger = 0x02524c0000aa;

  void SetUp() override {
    CalibrationInputsTest::SetUp();
    std::ofstream(points_) << "t_start,t_end,x,y,z\n1000.0,1001.0,0.1,0.2,1.2\n"
                              "1002.0,1003.0,0.3,0.2,1.2\n";
    record("first", {{1000, kDevice, 3}});
    record("second", {{1002, kDevice, 3}, {1002, kStranger, 10}});
  }
  void TearDown() override {
    CalibrationInputsTest::TearDown();
    std::filesystem::remove(file("first"));
    std::filesystem::remove(file("second"));
  }

  struct Burst {
    int second = 0;  // since 1970
    std::uint64_t transmitter = 0;
    int frames = 0;
  };
  std::string file(const std::string& name) const { return points_.string() + "." + name; }
  void record(const std::string& name, const std::vector<Burst>& bursts) const {
    std::filesystem::remove(file(name));
    auto recorder = PcapRecorder::create(file(name));
    ASSERT_TRUE(recorder) << recorder.error().message;
    test::WireFrame frame;
    frame.rx_chains = {0, 2, 3};
    for (const Burst& burst : bursts) {
      frame.transmitter = burst.transmitter;
      for (int i = 0; i < burst.frames; ++i) {
        ++frame.sequence;
        const Timestamp time =
            Timestamp(std::chrono::seconds(burst.second)) +
            std::chrono::milliseconds(100 + 20 * i + (burst.transmitter == kStranger ? 10 : 0));
        for (const auto& datagram : test::write_axcsi(frame, time)) {
          const Datagram view = datagram.view();
          ASSERT_TRUE(recorder->write(std::span(&view, 1)));
        }
      }
    }
    ASSERT_TRUE(recorder->sync());
  }
  Expected<CalibrationInputs> read(const Site& site, const std::vector<std::string>& names) const {
    std::vector<CaptureArgument> captures;
    captures.reserve(names.size());
    for (const std::string& name : names) {
      captures.push_back({"ap1", file(name)});
    }
    return read_calibration_inputs(site, captures, points_);
  }
};

TEST_F(SurveyOfTwoPoints, SelectsTheListedDeviceAmongOthers) {
  const auto inputs = read(bundled_site(), {"first", "second"});
  ASSERT_TRUE(inputs) << inputs.error().message;
  for (const SurveyedFrames& surveyed : inputs->points) {
    ASSERT_EQ(surveyed.frames.size(), 3U);
    for (const CsiFrame& frame : surveyed.frames) {
      EXPECT_EQ(to_string(frame.transmitter), "02:52:4c:00:00:01");
    }
  }
  ASSERT_EQ(inputs->refused.size(), 1U);
  EXPECT_EQ(inputs->refused[0].what, "02:52:4c:00:00:aa");
}

TEST_F(SurveyOfTwoPoints, SelectsTheMostFrequentDeviceIfNoneIsListed) {
  Site site = bundled_site();
  site.transmitters.clear();
  const auto inputs = read(site, {"first", "second"});
  ASSERT_TRUE(inputs) << inputs.error().message;
  EXPECT_EQ(inputs->points[1].frames.size(), 3U);
  EXPECT_EQ(to_string(inputs->points[1].frames[0].transmitter), "02:52:4c:00:00:01");
}

// As `rayloc survey` leaves them when it was interrupted and continued.
TEST_F(SurveyOfTwoPoints, IsReadFromSeveralRecordingsInAnyOrder) {
  const auto one = read(bundled_site(), {"first", "second"});
  const auto other = read(bundled_site(), {"second", "first"});
  ASSERT_TRUE(one && other);
  EXPECT_EQ(one->points[0].frames.size(), 3U);
  EXPECT_EQ(one->content, other->content);
}

// A checkpoint of the one must not be gone on from with the other.
TEST_F(CalibrationInputsTest, DistinguishesExchangedRecordings) {
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
}  // namespace rayloc::calibration_inputs_test
