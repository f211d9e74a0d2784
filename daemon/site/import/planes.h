// find_planes: approximates a dense scan by a few planes.
//
// Triangles with a uniformly oriented neighbourhood grow into regions about a plane that is
// refitted meanwhile. A region becomes rectangles: the part of its plane that the triangles cover.
//
// References: T. Rabbani, F. van den Heuvel, G. Vosselman, ISPRS Archives 36-5 (2006) 248.
#pragma once

#include <vector>

#include "engine/base/vec3.h"
#include "engine/scene/mesh.h"

namespace rayloc {

struct ScanPlane {
  Vec3d normal;  // on the facing side of the triangles
  Vec3d middle;
  double area = 0.0;   // [m^2], area of its triangles
  double error = 0.0;  // [m], rms distance of its triangles' centres
  Mesh mesh;           // exactly planar
};

struct ScanPlanes {
  std::vector<ScanPlane> planes;  // largest first
  double area = 0.0;              // [m^2], area of all triangles
  double kept_area = 0.0;         // [m^2], area of those in planes
  double tolerance = 0.0;         // [m], used value
};

// True for many small triangles: more than a person would draw.
// In a file that is a scan, smaller parts count as scanned too.
bool is_dense(const Mesh& mesh, bool in_scan = false);

// `tolerance` [m]: largest distance of a triangle from
// its plane; 0: three times the scan's own roughness.
ScanPlanes find_planes(const Mesh& mesh, double tolerance);

}  // namespace rayloc
