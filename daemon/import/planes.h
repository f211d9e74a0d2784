// find_planes: a dense scan as the few planes that it is of.
//
// Triangles whose neighbourhood faces one way grow into regions about a plane, which is fitted anew
// as they grow. A region becomes rectangles: what of its plane the triangles cover.
//
// References: T. Rabbani, F. van den Heuvel, G. Vosselman, ISPRS Archives 36-5 (2006) 248.
#pragma once

#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/mesh.h"

namespace rayloc {

struct ScanPlane {
  Vec3d normal;  // as the triangles face
  Vec3d middle;
  double area = 0.0;   // [m^2], of its triangles
  double error = 0.0;  // [m], rms distance of its triangles' middles
  Mesh mesh;           // exactly plane
};

struct ScanPlanes {
  std::vector<ScanPlane> planes;  // the largest first
  double area = 0.0;              // [m^2], of all triangles
  double kept_area = 0.0;         // [m^2], of those in planes
  double tolerance = 0.0;         // [m], that was used
};

// Many small triangles: more than a person would draw. Of a file that is a scan smaller parts are
// scanned as well.
bool is_dense(const Mesh& mesh, bool in_scan = false);

// `tolerance` [m]: how far a triangle may be from its plane; 0: three times the scan's own
// roughness.
ScanPlanes find_planes(const Mesh& mesh, double tolerance);

}  // namespace rayloc
