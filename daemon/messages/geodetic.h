// Latitude, longitude and height of a point of a site: local metres -> WGS 84.
//
// Exact at any distance from the site's origin: the tangent plane at the origin, rotated by the
// site's rotation, then the ellipsoid [EPSG 9837]. Not a map projection: a corridor of a kilometre
// keeps its true length and bearing.
//
// References: [EPSG 9837] IOGP 373-7-2, Geographic/topocentric conversions; [Bowring] B. R.
// Bowring, Transformation from spatial to geographical coordinates, 1976.
#pragma once

#include "engine/base/vec3.h"
#include "rayloc/v1/geometry.pb.h"

namespace rayloc {

struct GeodeticPoint {
  double latitude = 0.0;   // [degrees]
  double longitude = 0.0;  // [degrees], from -180 to 180
  double altitude = 0.0;   // [m] above the ellipsoid
};

GeodeticPoint to_geodetic(const v1::Georeference& site, const Vec3d& local);

// Course of a horizontal direction in the site: clockwise from true north, in [0, 360) degrees.
double course_deg(const v1::Georeference& site, double x, double y);

}  // namespace rayloc
