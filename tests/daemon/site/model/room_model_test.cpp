#include "daemon/site/model/room_model.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "daemon/site/model/calibration_file.h"
#include "daemon/site/model/site_copy.h"
#include "engine/scene/scene.h"
#include "tests/support/test_paths.h"

namespace rayloc::room_model_test {
namespace {

namespace fs = std::filesystem;

const fs::path kSite = fs::path(test::data_path()) / "sites" / "meeting_room";

// A folder of its own for each test, removed afterwards.
class RoomModelTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Gains of 1 for every access point of the bundled site, yaw rotated by 0.02 rad.
  static CalibrationFile calibration_of(const RoomModel& room) {
    CalibrationFile file;
    file.id = "0000000000000001";
    file.scene_hash = room.scene_hash;
    file.points_hash = "0000000000000002";
    file.likelihood_exponent = {0.5, 0.6, 0.0};
    for (const RoomAccessPoint& ap : room.access_points) {
      CalibratedAccessPoint one;
      one.id = ap.id;
      one.yaw_offset.value = 0.02;
      one.noise.value = 0.003;
      one.gains = {room.grid, ap.rx_chains, {}, {}};
      one.gains.gain.resize(ap.rx_chains.size() * room.grid.size(), 1.0);
      one.gain_sigma.resize(ap.rx_chains.size());
      one.element_y.resize(ap.rx_chains.size());
      file.access_points.push_back(std::move(one));
    }
    return file;
  }

  fs::path folder_;
};

TEST_F(RoomModelTest, LoadsTheBundledSite) {
  const auto site = load_site(kSite);
  ASSERT_TRUE(site) << site.error().message;
  const auto room = load_room_model(*site);
  ASSERT_TRUE(room) << room.error().message;
  EXPECT_EQ(room->scene->objects().size(), 19U);
  EXPECT_EQ(room->access_points.size(), 3U);
  EXPECT_TRUE(room->access_points[0].gains.empty());
  EXPECT_EQ(room->grid.size(), 114U);
  EXPECT_NEAR(room->bounds_max.x, 1.765, 1e-9);
  EXPECT_EQ(room->device.height, 1.2);
  EXPECT_EQ(room->device.pattern, AntennaPattern::kHalfWaveDipole);
}

TEST_F(RoomModelTest, AppliesTheMaterialsThatTheSiteStates) {
  auto site = load_site(kSite);
  ASSERT_TRUE(site);
  const auto before = load_room_model(*site);
  ASSERT_TRUE(before);
  site->materials["concrete"].thickness = 0.37;
  const auto after = load_room_model(*site);
  ASSERT_TRUE(after);
  EXPECT_NE(before->scene_hash, after->scene_hash);
  bool found = false;
  for (const RadioMaterial& material : after->scene->materials()) {
    found = found || (material.name == "concrete" && material.thickness == 0.37);
  }
  EXPECT_TRUE(found);
}

TEST_F(RoomModelTest, ACopyEqualsTheOriginalWithItsCalibration) {
  const auto site = load_site(kSite);
  ASSERT_TRUE(site);
  const auto room = load_room_model(*site);
  ASSERT_TRUE(room);
  ASSERT_TRUE(prepare_output(folder_, false));
  const auto written = write_site(*site, to_toml(calibration_of(*room)), folder_);
  ASSERT_TRUE(written) << written.error().message;
  const auto copy = load_site(folder_);
  ASSERT_TRUE(copy) << copy.error().message;
  EXPECT_EQ(copy->scene_file, folder_ / "scene.xml");
  const auto calibrated = load_room_model(*copy);
  ASSERT_TRUE(calibrated) << calibrated.error().message;
  EXPECT_EQ(calibrated->scene_hash, room->scene_hash);
  EXPECT_EQ(calibrated->calibration_id, "0000000000000001");
  EXPECT_EQ(calibrated->likelihood_exponent, 0.5);
  EXPECT_EQ(calibrated->access_points[2].error.noise, 0.003);
  EXPECT_FALSE(calibrated->access_points[2].gains.empty());
  EXPECT_NEAR(calibrated->access_points[2].array.pose.orientation.yaw,
              room->access_points[2].array.pose.orientation.yaw + 0.02,
              1e-12);
}

// The calibration states the powers; the site now states which transmitters are constant.
TEST_F(RoomModelTest, UsesPowerLawsOfConstantTransmittersOnly) {
  const auto site = load_site(kSite);
  ASSERT_TRUE(site);
  const auto room = load_room_model(*site);
  ASSERT_TRUE(room);
  ASSERT_EQ(site->transmitters.size(), 2U);
  CalibrationFile calibration = calibration_of(*room);
  calibration.access_points[1].powers = {{site->transmitters[0].mac, -30.0, 1.0},
                                         {*parse_mac_address("02:00:00:00:00:99"), -40.0, 2.0},
                                         {site->transmitters[1].mac, -50.0, 3.0}};
  ASSERT_TRUE(prepare_output(folder_, false));
  ASSERT_TRUE(write_site(*site, to_toml(calibration), folder_));
  auto stated = load_site(folder_);
  ASSERT_TRUE(stated) << stated.error().message;

  const auto silent = load_room_model(*stated);  // constant_power is not stated
  ASSERT_TRUE(silent) << silent.error().message;
  for (const RoomAccessPoint& ap : silent->access_points) {
    EXPECT_TRUE(ap.powers.empty()) << ap.id;
  }

  stated->transmitters[1].constant_power = true;
  const auto constant = load_room_model(*stated);
  ASSERT_TRUE(constant) << constant.error().message;
  EXPECT_TRUE(constant->access_points[0].powers.empty());
  const auto& powers = constant->access_points[1].powers;
  ASSERT_EQ(powers.size(), 1U);
  EXPECT_EQ(powers[0].transmitter, site->transmitters[1].mac);
  EXPECT_EQ(powers[0].offset_db, -50.0);
  EXPECT_EQ(powers[0].sigma_db, 3.0);
}

TEST_F(RoomModelTest, RefusesTheCalibrationOfAnotherScene) {
  const auto site = load_site(kSite);
  ASSERT_TRUE(site);
  const auto room = load_room_model(*site);
  ASSERT_TRUE(room);
  CalibrationFile calibration = calibration_of(*room);
  calibration.scene_hash = "0000000000000000";
  ASSERT_TRUE(prepare_output(folder_, false));
  ASSERT_TRUE(write_site(*site, to_toml(calibration), folder_));
  const auto refused = load_room_model(*load_site(folder_));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kConfiguration);
  EXPECT_NE(refused.error().message.find("made for another scene"), std::string::npos)
      << refused.error().message;
}

TEST_F(RoomModelTest, RefusesTheCalibrationOfAnAccessPointThatIsNotThere) {
  const auto site = load_site(kSite);
  ASSERT_TRUE(site);
  const auto room = load_room_model(*site);
  ASSERT_TRUE(room);
  CalibrationFile calibration = calibration_of(*room);
  calibration.access_points[1].id = "attic";
  ASSERT_TRUE(prepare_output(folder_, false));
  ASSERT_TRUE(write_site(*site, to_toml(calibration), folder_));
  const auto refused = load_room_model(*load_site(folder_));
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("no access point 'attic'"), std::string::npos)
      << refused.error().message;
}

// A reference holds phases that only its own calibration explains.
TEST_F(RoomModelTest, ACopyOfASiteWithoutItsReferenceNamesNone) {
  auto site = load_site(kSite);
  ASSERT_TRUE(site);
  const auto room = load_room_model(*site);
  ASSERT_TRUE(room);
  ASSERT_TRUE(prepare_output(folder_, false));
  ASSERT_TRUE(write_file(folder_ / "reference.toml", "format = 1\n"));
  site->reference_file = folder_ / "reference.toml";
  ASSERT_TRUE(write_site(*site, to_toml(calibration_of(*room)), folder_));
  auto with = load_site(folder_);
  ASSERT_TRUE(with && with->reference_file);
  with->reference_file.reset();
  ASSERT_TRUE(write_site(*with, to_toml(calibration_of(*room)), folder_));
  const auto without = load_site(folder_);
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_FALSE(without->reference_file);
}

TEST_F(RoomModelTest, AnOutputIsNoInputEvenIfForced) {
  ASSERT_TRUE(prepare_output(folder_, false));
  EXPECT_TRUE(check_output(folder_, kSite, false));
  EXPECT_TRUE(check_output(folder_ / "new", folder_, false));
  const auto same = check_output(folder_ / ".." / folder_.filename(), folder_, true);
  ASSERT_FALSE(same);
  EXPECT_NE(same.error().message.find("is the site that is read"), std::string::npos);
}

TEST_F(RoomModelTest, OutputFolderMustBeEmptyUnlessForced) {
  ASSERT_TRUE(prepare_output(folder_, false));
  ASSERT_TRUE(write_file(folder_ / "note", "mine"));
  EXPECT_FALSE(prepare_output(folder_, false));
  EXPECT_TRUE(prepare_output(folder_, true));
}

}  // namespace
}  // namespace rayloc::room_model_test
