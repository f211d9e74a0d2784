#include "daemon/site/model/site.h"

#include <filesystem>
#include <numbers>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/site/model/keys/site_keys.h"
#include "tests/daemon/site/model/site_text.h"
#include "tests/support/test_paths.h"

namespace rayloc::site_test {
namespace {

namespace fs = std::filesystem;
using testing::errors_of;
using ::testing::HasSubstr;
using testing::kSiteFile;
using testing::site_text;

TEST(Site, ReadsTheBundledSite) {
  const Expected<Site> site = load_site(kSiteFile.parent_path());
  ASSERT_TRUE(site) << site.error().message;
  EXPECT_EQ(site->name, "meeting_room");
  EXPECT_EQ(site->scene_file, kSiteFile.parent_path() / "scene.xml");
  EXPECT_EQ(site->access_points.size(), 3U);
  EXPECT_EQ(site->access_points[2].id, "ap3");
  EXPECT_EQ(site->access_points[0].rx_chains, (std::vector<std::uint8_t>{2, 0, 3}));
  EXPECT_EQ(site->carrier.grid.size(), 114U);
  EXPECT_EQ(site->materials.size(), 6U);
}

TEST(Site, ReadsEveryKey) {
  const Expected<Site> site = parse_site(site_text(), kSiteFile);
  ASSERT_TRUE(site) << site.error().message;
  EXPECT_TRUE(site->has_bounds);
  EXPECT_EQ(site->bounds_min, (Vec3d{-1.765, -1.425, 0}));
  EXPECT_EQ(site->bounds_max, (Vec3d{1.765, 1.425, 2.7}));
  EXPECT_EQ(site->carrier.channel, 36);
  EXPECT_EQ(site->carrier.bandwidth_mhz, 40);
  EXPECT_EQ(site->carrier.grid.centre_hz, 5.19e9);
  EXPECT_EQ(site->carrier.grid.spacing_hz, 312'500.0);
  EXPECT_EQ(site->carrier.grid.tone_index.front(), -58);
  EXPECT_EQ(site->carrier.grid.tone_index.back(), 58);
  ASSERT_EQ(site->access_points.size(), 1U);
  const SiteAccessPoint& ap = site->access_points[0];
  EXPECT_EQ(ap.format, "axcsi-v4");
  EXPECT_EQ(ap.array.pose.position, (Vec3d{-1.4, 1.05, 1.2}));
  EXPECT_DOUBLE_EQ(ap.array.pose.orientation.yaw, -37.0 * std::numbers::pi / 180.0);
  EXPECT_EQ(ap.array.pattern, AntennaPattern::kHalfWaveDipole);
  EXPECT_EQ(ap.rx_chains, (std::vector<std::uint8_t>{2, 0}));
  EXPECT_EQ(ap.array.element_offset[0], (Vec3d{0, -0.089, 0}));
  ASSERT_EQ(site->transmitters.size(), 2U);
  EXPECT_EQ(site->transmitters[0].role, TransmitterRole::kDevice);
  EXPECT_EQ(site->transmitters[0].height, 1.1);
  EXPECT_FALSE(site->transmitters[0].position);
  EXPECT_FALSE(site->transmitters[0].constant_power);
  EXPECT_EQ(site->transmitters[1].position, (Vec3d{1.25, -0.45, 1.2}));
  EXPECT_EQ(to_string(site->transmitters[1].mac), "02:52:4c:00:00:02");
  EXPECT_EQ(site->person->area_radius, 4.5);
  EXPECT_EQ(site->materials.at("glass").thickness, 0.004);
  EXPECT_FALSE(site->materials.at("glass").conductivity);
  EXPECT_DOUBLE_EQ(site->georeference->rotation, std::numbers::pi / 2.0);
  EXPECT_EQ(site->zones.at(0).polygon.size(), 3U);
  EXPECT_EQ(site->zones.at(0).enter_probability, 0.7);
  EXPECT_EQ(site->zones.at(0).leave_after, std::chrono::seconds(1));
  EXPECT_FALSE(site->targets.track_unlisted);
}

TEST(Site, ReadsWhenATargetEntersAndLeavesAZone) {
  const auto stated =
      parse_site(site_text("[1, 0], [1, 1]]\n",
                           "[1, 0], [1, 1]]\nenter_probability = 0.6\nleave_probability = 0.1\n"
                           "enter_after_s = 0\nleave_after_s = 2.5\ndwell_after_s = 60\n"),
                 kSiteFile);
  ASSERT_TRUE(stated) << stated.error().message;
  const SiteZone& zone = stated->zones.at(0);
  EXPECT_EQ(zone.enter_probability, 0.6);
  EXPECT_EQ(zone.leave_probability, 0.1);
  EXPECT_EQ(zone.enter_after, Duration{});
  EXPECT_EQ(zone.leave_after, std::chrono::milliseconds(2500));
  EXPECT_EQ(zone.dwell_after, std::chrono::minutes(1));
}

TEST(Site, WarnsOfZonesOutsideOfTheRoom) {
  const auto site = parse_site(
      site_text("polygon = [[0, 0], [1, 0], [1, 1]]", "polygon = [[0, 0], [100, 0], [1, 1]]"),
      kSiteFile);
  ASSERT_TRUE(site) << site.error().message;
  const auto warnings = zone_warnings(*site, site->bounds_min, site->bounds_max);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(testing::without_folder(warnings[0], kSiteFile),
            "site.toml:48:1: warning: zone 'desk' has a corner at 100, 0, outside of the room: x "
            "from -1.765 to 1.765, y from -1.425 to 1.425");
  const auto inside = parse_site(site_text(), kSiteFile);
  EXPECT_TRUE(zone_warnings(*inside, site->bounds_min, site->bounds_max).empty());
}

TEST(Site, TakesEveryTonePlanOfTheDatasets) {
  const auto with_carrier = [](std::string_view lines) {
    const std::string stated =
        "bandwidth_mhz = 40\ncentre_hz = 5190000000\ntones = 128\ntone_spacing_hz = 312500\n"
        "active = [[-58, -2], [2, 58]]\n";
    return parse_site(site_text(stated, lines), kSiteFile);
  };
  const auto vht20 = with_carrier(
      "bandwidth_mhz = 20\ncentre_hz = 5180000000\ntones = 64\nactive = [[-28, -1], [1, 28]]\n");
  ASSERT_TRUE(vht20) << vht20.error().message;
  EXPECT_EQ(vht20->carrier.grid.size(), 56U);
  const auto vht80 = with_carrier(
      "bandwidth_mhz = 80\ncentre_hz = 5210000000\ntones = 256\nactive = [[-122, -2], [2, 122]]\n");
  ASSERT_TRUE(vht80) << vht80.error().message;
  EXPECT_EQ(vht80->carrier.grid.size(), 242U);
  const auto he20 = with_carrier(
      "bandwidth_mhz = 20\ncentre_hz = 5180000000\ntones = 256\ntone_spacing_hz = 78125\n"
      "active = [[-122, -2], [2, 122]]\n");
  ASSERT_TRUE(he20) << he20.error().message;
  EXPECT_EQ(he20->carrier.grid.spacing_hz, 78'125.0);
}

TEST(Site, HeightOfADeviceDefaultsToThatOfTargets) {
  std::string text = site_text("height_m = 1.1\n", "");
  text += "height_m = 0.8\n";  // the text ends with [targets]
  const Expected<Site> site = parse_site(text, kSiteFile);
  ASSERT_TRUE(site) << site.error().message;
  EXPECT_EQ(site->transmitters[0].height, 0.8);
}

TEST(Site, HeightIsUnknownUnlessItIsStated) {
  const Expected<Site> unstated = parse_site(site_text(), kSiteFile);
  ASSERT_TRUE(unstated) << unstated.error().message;
  EXPECT_EQ(unstated->targets.height_sigma, 0.3);
  EXPECT_EQ(unstated->transmitters[0].height_sigma, 0.3);
  // The text ends with [targets]; the deviation of a tag of known height is stated as 0.
  const Expected<Site> stated = parse_site(
      site_text("height_m = 1.1", "height_m = 1.1\nheight_sigma_m = 0") + "height_sigma_m = 0.2\n",
      kSiteFile);
  ASSERT_TRUE(stated) << stated.error().message;
  EXPECT_EQ(stated->targets.height_sigma, 0.2);
  EXPECT_EQ(stated->transmitters[0].height_sigma, 0.0);
  EXPECT_NE(errors_of(site_text() + "height_sigma_m = -0.1\n").find("height_sigma_m"),
            std::string::npos);
}

// Each key that the table of keys gives a default: stating that changes nothing.
TEST(Site, DefaultsAreThoseOfTheTableOfKeys) {
  std::string bare = site_text("pattern = \"half_wave_dipole\"\npolarization = \"V\"\n", "");
  for (const char* line : {"tone_spacing_hz = 312500\n",
                           "yaw_deg = -37\npitch_deg = 0\nroll_deg = 0\n",
                           "height_m = 1.1\n",
                           "radius_m = 0.165\nheight_m = 1.7\n",
                           "rotation_deg = 90\n",
                           "unlisted = \"ignore\"\n"}) {
    bare = testing::edited_text(bare, line, "");
  }
  std::string stated = bare;
  int rows = 0;
  for (const SiteKey& key : site_keys()) {
    if (key.preset.empty()) {
      continue;
    }
    for (const std::string& header :
         {"[" + std::string(key.table) + "]\n", "[[" + std::string(key.table) + "]]\n"}) {
      if (stated.find("\n" + header) != std::string::npos) {
        stated = testing::edited_text(
            stated, header, header + std::string(key.key) + " = " + std::string(key.preset) + "\n");
        ++rows;
      }
    }
  }
  EXPECT_EQ(rows, 21) << "a new default needs a line below";
  const Expected<Site> left_out = parse_site(bare, kSiteFile);
  const Expected<Site> spelt = parse_site(stated, kSiteFile);
  ASSERT_TRUE(left_out) << left_out.error().message;
  ASSERT_TRUE(spelt) << spelt.error().message;
  const auto values = [](const Site& site) {
    const AntennaArray& array = site.access_points[0].array;
    const SiteTransmitter& device = site.transmitters[0];
    const SiteZone& zone = site.zones[0];
    return std::tuple(
        site.carrier.grid.spacing_hz,
        std::tuple(array.pose.orientation.yaw,
                   array.pose.orientation.pitch,
                   array.pose.orientation.roll,
                   to_string(array.pattern),
                   array.polarization),
        std::tuple(
            to_string(device.pattern), device.polarization, device.constant_power, device.height),
        std::tuple(site.targets.track_unlisted, site.targets.height, site.targets.height_sigma),
        std::tuple(site.person->radius, site.person->height),
        std::tuple(zone.enter_probability,
                   zone.leave_probability,
                   zone.enter_after,
                   zone.leave_after,
                   zone.dwell_after),
        std::tuple(site.georeference->altitude, site.georeference->rotation));
  };
  EXPECT_EQ(values(*left_out), values(*spelt));
}

TEST(Site, CalibrationFileIsBesideSiteToml) {
  EXPECT_EQ(errors_of(site_text() + "[calibration]\nfile = \"calibration.toml\"\n"),
            "site.toml:54:8: 'file': no file calibration.toml; paths are relative to the folder of "
            "site.toml");
  const Expected<Site> site =
      parse_site(site_text() + "[calibration]\nfile = \"scene.xml\"\n", kSiteFile);
  ASSERT_TRUE(site) << site.error().message;
  EXPECT_EQ(site->calibration_file, kSiteFile.parent_path() / "scene.xml");
}

TEST(Site, IsReadFromADirectoryOrAFile) {
  EXPECT_TRUE(load_site(kSiteFile.parent_path()));
  EXPECT_TRUE(load_site(kSiteFile));
  const Expected<Site> nothing = load_site(fs::path(test::data_path()) / "sites");
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().kind, ErrorKind::kConfiguration);
  EXPECT_THAT(nothing.error().message, HasSubstr("sites/site.toml: there is no such file"));
}

TEST(Site, FindsAccessPointsAndTransmitters) {
  const Expected<Site> site = load_site(kSiteFile);
  ASSERT_TRUE(site);
  EXPECT_EQ(find_access_point(*site, "ap2"), 1U);
  EXPECT_EQ(find_access_point(*site, "ap9").error().message,
            "the site has no access point 'ap9'; it has: ap1, ap2, ap3");
  EXPECT_EQ(find_transmitter(*site, *parse_mac_address("02-52-4C-00-00-02"))->role,
            TransmitterRole::kFixed);
  EXPECT_EQ(find_transmitter(*site, MacAddress{}), nullptr);
}

}  // namespace
}  // namespace rayloc::site_test
