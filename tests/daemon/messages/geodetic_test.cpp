#include "daemon/messages/geodetic.h"
#include "engine/base/constants.h"

#include <cmath>

#include <gtest/gtest.h>

namespace rayloc::geodetic_test {
namespace {

v1::Georeference site_at(double latitude, double longitude, double altitude, double rotation) {
  v1::Georeference site;
  site.set_latitude_deg(latitude);
  site.set_longitude_deg(longitude);
  site.set_altitude_m(altitude);
  site.set_rotation_deg(rotation);
  return site;
}

// The example of IOGP Publication 373-7-2 (EPSG guidance note 7-2), method 9837: a ship at
// 53 48'33.820" N, 2 07'46.380" E, 73.0 m, seen from a platform.
TEST(Geodetic, IsThatOfTheExampleOfEpsg) {
  const GeodeticPoint point =
      to_geodetic(site_at(55.0, 5.0, 200.0, 0.0), {-189'013.869, -128'642.040, -4'220.171});
  EXPECT_NEAR(point.latitude, 53.0 + 48.0 / 60.0 + 33.820 / 3600.0, 0.0006 / 3600.0);
  EXPECT_NEAR(point.longitude, 2.0 + 7.0 / 60.0 + 46.380 / 3600.0, 0.0006 / 3600.0);
  EXPECT_NEAR(point.altitude, 73.0, 0.001);
}

// Near the origin: the radii of curvature of the meridian and of the parallel.
TEST(Geodetic, FollowsTheRadiiOfCurvature) {
  constexpr double kE2 = 0.00669437999014;  // WGS 84, as published
  for (const double latitude : {-70.0, -0.5, 0.0, 33.3, 52.52}) {
    const double root = std::sqrt(1.0 - kE2 * std::pow(std::sin(latitude * kDegree), 2));
    const double meridian = 6'378'137.0 * (1.0 - kE2) / std::pow(root, 3);
    const double normal = 6'378'137.0 / root;
    const GeodeticPoint point = to_geodetic(site_at(latitude, 13.4, 35.0, 0.0), {12.0, -7.0, 1.5});
    EXPECT_NEAR((point.latitude - latitude) * kDegree * (meridian + 35.0), -7.0, 1e-4);
    EXPECT_NEAR((point.longitude - 13.4) * kDegree * (normal + 35.0) * std::cos(latitude * kDegree),
                12.0,
                1e-4);
    EXPECT_NEAR(point.altitude, 36.5, 1e-4);
  }
}

TEST(Geodetic, RotatesTheSiteAnticlockwiseFromEast) {
  const v1::Georeference site = site_at(50.0, 8.0, 0.0, 90.0);  // +x looks north
  const GeodeticPoint north = to_geodetic(site, {100.0, 0.0, 0.0});
  EXPECT_NEAR(north.longitude, 8.0, 1e-9);
  EXPECT_GT(north.latitude, 50.0008);
  EXPECT_LT(to_geodetic(site, {0.0, 100.0, 0.0}).longitude, 7.999);
  EXPECT_NEAR(course_deg(site, 1.0, 0.0), 0.0, 1e-9);
  EXPECT_NEAR(course_deg(site, 0.0, 1.0), 270.0, 1e-9);
  EXPECT_NEAR(course_deg(site_at(50.0, 8.0, 0.0, 0.0), 1.0, 0.0), 90.0, 1e-9);
}

TEST(Geodetic, HandlesThePolesAndTheDateLine) {
  const GeodeticPoint pole = to_geodetic(site_at(90.0, 0.0, 0.0, 0.0), {0.0, 0.0, 2.0});
  EXPECT_NEAR(pole.latitude, 90.0, 1e-9);
  EXPECT_NEAR(pole.altitude, 2.0, 1e-6);
  EXPECT_LT(to_geodetic(site_at(0.0, 179.9999, 0.0, 0.0), {100.0, 0.0, 0.0}).longitude, -179.99);
}

}  // namespace
}  // namespace rayloc::geodetic_test
