// RayShooter: the first surface that each of many rays meets.
//
// For proposals only: Embree's triangles in single precision. A ray that passes an edge or a corner
// within rounding may be assigned to either neighbour, or in a crack between two faces to the
// surface behind. Exact tests are those of Bvh.
//
// Rays are processed in streams, as arrays, and relative to origin(), so that rooms far from the
// world's origin lose no precision. Streams are fastest when neighbouring rays are close in space.
//
// Thread safety: const members may be used from many threads.
//
// References: Embree 3 API, rtcIntersectNp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/scene/surface.h"

namespace rayloc {

struct RayStream {
  // A count of rays, chosen: a stream fits in the first-level cache.
  static constexpr std::size_t kCapacity = 256;
  template <typename T>
  using Lanes = std::array<T, kCapacity>;

  std::size_t size = 0;
  alignas(64) Lanes<float> origin_x, origin_y, origin_z;  // [m], relative to RayShooter::origin()
  alignas(64) Lanes<float> direction_x, direction_y, direction_z;  // unit
  // Results.
  alignas(64) Lanes<float> distance;          // [m]
  alignas(64) Lanes<std::uint32_t> triangle;  // kNoTriangle: no hit
};

class RayShooter {
 public:
  static constexpr std::uint32_t kNoTriangle = 0xffffffff;  // the index of no triangle
  struct Triangle {
    float normal_x, normal_y, normal_z;  // unit, that of the surface
    std::uint32_t surface;
  };

  // An Error when Embree cannot be used on this machine.
  static Expected<RayShooter> create(std::span<const Surface> surfaces);
  ~RayShooter();
  RayShooter(RayShooter&&) noexcept;
  RayShooter& operator=(RayShooter&&) noexcept;

  // Finds the first hit of each ray beyond `nearest` [m].
  void shoot(RayStream& stream, float nearest) const;

  std::span<const Triangle> triangles() const;
  const Vec3d& origin() const;
  // A ray that leaves a surface may meet it again within this distance, by rounding [m].
  float clearance() const;

 private:
  class Impl;
  explicit RayShooter(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

}  // namespace rayloc
