// <transform name="to_world">: translate, rotate, scale and matrix, in the order written. Internal
// to load_scene.
#pragma once

#include <cstddef>
#include <string>

#include <pugixml.hpp>

#include "engine/base/mat3.h"
#include "engine/base/vec3.h"
#include "engine/scene/read/xml_file.h"

namespace rayloc {

// x -> linear x + offset.
struct AffineTransform {
  Mat3d linear;
  Vec3d offset;

  Vec3d apply(const Vec3d& v) const { return linear * v + offset; }
};

// <rotate>s whose axis is no unit vector. Mitsuba does not normalise it and deforms the mesh.
struct OddAxes {
  std::size_t count = 0;
  std::string first;    // its place
  double length = 0.0;  // of the first
};

// Steps that cannot be read are reported and left out.
AffineTransform read_transform(XmlFile& file, const pugi::xml_node& transform, OddAxes& odd_axes);

}  // namespace rayloc
