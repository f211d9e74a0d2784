// Bvh: tests whether a surface blocks the segment between two points.
//
// Embree works in single precision. It only proposes pieces of surfaces that the segment may meet:
// their boxes are widened by more than its rounding, so it proposes too many, never too few. Each
// proposal is decided in double precision. The result is therefore that of double precision for
// every ray, also through seams, along walls and near the ends.
//
// A segment is blocked when it crosses a surface
//   - that is not one of the two which it touches (a segment that starts on a plane cannot cross
//     that plane again), and
//   - more than kEndTolerance away from both ends, so that a wall does not block a device on it.
// A segment that runs within a plane does not cross it.
//
// Thread safety: const members may be used from many threads.
//
// References: Embree 3 API, user geometries (RTC_GEOMETRY_TYPE_USER).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/expected.h"
#include "engine/base/vec3.h"
#include "engine/scene/surface.h"

namespace rayloc {

inline constexpr double kEndTolerance = 1e-9;            // [m]
inline constexpr std::uint32_t kNoSurface = 0xffffffff;  // no surface at the end

struct Segment {
  Vec3d from;
  Vec3d to;
  std::uint32_t from_surface = kNoSurface;  // the surface that the end lies on, if any
  std::uint32_t to_surface = kNoSurface;
};

// Intersection of a segment with a surface.
struct Crossing {
  std::uint32_t surface = kNoSurface;
  double share = 0.0;  // of the segment, from its start, in (0, 1)
};

class Bvh {
 public:
  // `surfaces` must outlive the Bvh and keep their address. `margin`: distance outside its edges at
  // which a surface is still met [m]. An Error when Embree cannot be used on this machine.
  static Expected<Bvh> create(std::span<const Surface> surfaces, double margin = 0.0);
  ~Bvh();
  Bvh(Bvh&&) noexcept;
  Bvh& operator=(Bvh&&) noexcept;

  bool is_blocked(const Segment& segment) const;
  // Finds every surface that blocks the segment, once, in the order of the segment.
  void crossings(const Segment& segment, std::vector<Crossing>& found) const;

 private:
  class Impl;
  explicit Bvh(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

}  // namespace rayloc
