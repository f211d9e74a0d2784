// Mat3<T>: a 3 x 3 matrix, and the rotation of a body given by yaw, pitch and roll.
#pragma once

#include <cmath>

#include "engine/base/vec3.h"

namespace rayloc {

template <typename T>
struct Mat3 {
  Vec3<T> row0{T(1), T(0), T(0)};
  Vec3<T> row1{T(0), T(1), T(0)};
  Vec3<T> row2{T(0), T(0), T(1)};

  friend Vec3<T> operator*(const Mat3& m, const Vec3<T>& v) {
    return {dot(m.row0, v), dot(m.row1, v), dot(m.row2, v)};
  }
};

using Mat3d = Mat3<double>;

// transpose(m) v: for a rotation, its inverse.
template <typename T>
Vec3<T> transpose_times(const Mat3<T>& m, const Vec3<T>& v) {
  return v.x * m.row0 + v.y * m.row1 + v.z * m.row2;
}

// world from body: R = Rz(yaw) Ry(pitch) Rx(roll), radians.
template <typename T>
Mat3<T> rotation_from_yaw_pitch_roll(const T& yaw, const T& pitch, const T& roll) {
  using std::cos;
  using std::sin;
  const T ca = cos(yaw);
  const T sa = sin(yaw);
  const T cb = cos(pitch);
  const T sb = sin(pitch);
  const T cc = cos(roll);
  const T sc = sin(roll);
  return {{ca * cb, ca * sb * sc - sa * cc, ca * sb * cc + sa * sc},
          {sa * cb, sa * sb * sc + ca * cc, sa * sb * cc - ca * sc},
          {-sb, cb * sc, cb * cc}};
}

}  // namespace rayloc
