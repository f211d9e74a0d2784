#include "daemon/site/model/site_lacks.h"

#include <array>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/site/model/room_model.h"
#include "tests/support/test_paths.h"

namespace rayloc::site_lacks_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The bundled room: three access points and a fixed transmitter, nothing calibrated.
class LackingSite {
 public:
  LackingSite() { site.transmitters.back().role = TransmitterRole::kFixed; }

  void calibrate(std::size_t access_point) {
    RoomAccessPoint& ap = room.access_points.at(access_point);
    ap.gains.grid = room.grid;
    ap.gains.rx_chains = ap.rx_chains;
    ap.gains.gain.assign(ap.rx_chains.size() * room.grid.size(), 1.0);
  }

  Site site = load_site(std::filesystem::path(test::data_path()) / "sites/meeting_room").value();
  RoomModel room = load_room_model(site).value();
};

TEST(Field, ASiteThatIsNotCalibratedCannotLocate) {
  LackingSite all;
  all.site.reference_file = "people.toml";
  EXPECT_THAT(site_lacks(all.site, all.room).obstacles,
              ElementsAre(HasSubstr("nothing can be located: the site is not calibrated; see "
                                    "`rayloc calibrate --help`")));
  EXPECT_THAT(site_lacks(all.site, all.room).warnings, IsEmpty());
}

TEST(Field, AnAccessPointThatIsNotCalibratedIsNamed) {
  LackingSite all;
  all.site.reference_file = "people.toml";
  all.calibrate(0);
  all.calibrate(1);
  const SiteLacks lacks = site_lacks(all.site, all.room);
  EXPECT_THAT(lacks.obstacles, IsEmpty());
  EXPECT_THAT(lacks.warnings,
              ElementsAre(HasSubstr("access point ap3 has no chain gains: calibrate the site")));
  all.calibrate(2);
  EXPECT_THAT(site_lacks(all.site, all.room).all(), IsEmpty());
}

TEST(Field, AccessPointsInUseDecideIfASiteCanLocate) {
  LackingSite all;
  all.site.reference_file = "people.toml";
  all.calibrate(0);
  constexpr std::array<std::size_t, 1> kCalibrated{0};
  constexpr std::array<std::size_t, 2> kOthers{1, 2};
  EXPECT_THAT(site_lacks(all.site, all.room, kCalibrated).all(), IsEmpty());
  EXPECT_THAT(
      site_lacks(all.site, all.room, kOthers).obstacles,
      ElementsAre(HasSubstr(
          "nothing can be located: the access points in use are not calibrated (ap2, ap3)")));
}

TEST(Field, AFixedTransmitterWithoutAReferenceCausesAWarning) {
  LackingSite all;
  for (std::size_t i = 0; i < all.room.access_points.size(); ++i) {
    all.calibrate(i);
  }
  EXPECT_THAT(site_lacks(all.site, all.room).warnings,
              ElementsAre(HasSubstr("people are not looked for")));
  all.site.transmitters.clear();
  EXPECT_THAT(site_lacks(all.site, all.room).all(), IsEmpty()) << "nobody expects people there";
}

}  // namespace
}  // namespace rayloc::site_lacks_test
