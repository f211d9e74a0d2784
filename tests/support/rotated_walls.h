// Walls as in real files: in any orientation, far from the origin, of few triangles or of many.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "engine/base/mat3.h"
#include "engine/scene/mesh.h"

namespace rayloc::test {

// x -> turn x + shift.
struct RigidMotion {
  Mat3d turn;
  Vec3d shift;

  Vec3d operator()(const Vec3d& v) const { return turn * v + shift; }
  Mesh operator()(Mesh mesh) const {
    for (Vec3d& v : mesh.vertices) {
      v = (*this)(v);
    }
    return mesh;
  }
};

// Rotations are uniformly distributed; shifts are up to `reach` [m] along each axis.
inline RigidMotion random_motion(std::mt19937_64& random, double reach) {
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  const double yaw = std::numbers::pi * share(random);
  const double pitch = std::asin(share(random));
  const double roll = std::numbers::pi * share(random);
  return {rotation_from_yaw_pitch_roll(yaw, pitch, roll),
          {reach * share(random), reach * share(random), reach * share(random)}};
}

// Each triangle as n^2 of its shape, with separate vertices.
inline Mesh subdivided(const Mesh& mesh, std::uint32_t n) {
  Mesh fine;
  for (const auto& t : mesh.triangles) {
    const Vec3d& a = mesh.vertices[t[0]];
    const Vec3d u = (1.0 / n) * (mesh.vertices[t[1]] - a);
    const Vec3d v = (1.0 / n) * (mesh.vertices[t[2]] - a);
    const auto first = static_cast<std::uint32_t>(fine.vertices.size());
    const auto at = [&](std::uint32_t i, std::uint32_t j) {  // i along u, j along v
      return first + j * (2 * n + 3 - j) / 2 + i;
    };
    for (std::uint32_t j = 0; j <= n; ++j) {
      for (std::uint32_t i = 0; i + j <= n; ++i) {
        fine.vertices.push_back(a + static_cast<double>(i) * u + static_cast<double>(j) * v);
      }
    }
    for (std::uint32_t j = 0; j < n; ++j) {
      for (std::uint32_t i = 0; i + j < n; ++i) {
        fine.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
        if (i + j + 1 < n) {
          fine.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
      }
    }
  }
  return fine;
}

// Rounded to float, as in a file.
inline Mesh rounded_to_float(Mesh mesh) {
  for (Vec3d& v : mesh.vertices) {
    for (double* x : {&v.x, &v.y, &v.z}) {
      *x = static_cast<double>(static_cast<float>(*x));
      mesh.rounding = std::max(mesh.rounding, 0x1p-24 * std::abs(*x));
    }
  }
  return mesh;
}

}  // namespace rayloc::test
