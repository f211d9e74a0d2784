// Bvh: is something in the way between two points?
//
// Embree works in single precision. It only proposes pieces of surfaces that the segment may meet:
// their boxes are widened by more than its rounding, so it proposes too many, never too few. Each
// proposal is decided in double precision. The verdict is therefore that of double precision for
// every ray, also through seams, along walls and near the ends.
//
// A segment is blocked when it crosses a surface
//   - that is not one of the two which it touches (a segment that starts on a plane cannot cross
//     that plane again), and
//   - more than kEndTolerance away from both ends, so that a device mounted on a wall is heard.
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
inline constexpr std::uint32_t kNoSurface = 0xffffffff;  // an end that touches nothing

struct Segment {
  Vec3d from;
  Vec3d to;
  std::uint32_t from_surface = kNoSurface;  // the surface that the end lies on, if any
  std::uint32_t to_surface = kNoSurface;
};

// Where a segment crosses a surface.
struct Crossing {
  std::uint32_t surface = kNoSurface;
  double share = 0.0;  // of the segment, from its start, in (0, 1)
};

class Bvh {
 public:
  // `surfaces` must outlive the Bvh and stay where they are. `margin`: how far outside its edges a
  // surface is still met [m]. An Error when Embree cannot work here.
  static Expected<Bvh> create(std::span<const Surface> surfaces, double margin = 0.0);
  ~Bvh();
  Bvh(Bvh&&) noexcept;
  Bvh& operator=(Bvh&&) noexcept;

  bool is_blocked(const Segment& segment) const;
  // Every surface that blocks the segment, once, in the order of the segment.
  void crossings(const Segment& segment, std::vector<Crossing>& found) const;

 private:
  class Impl;
  explicit Bvh(std::unique_ptr<const Impl> impl);
  std::unique_ptr<const Impl> impl_;
};

}  // namespace rayloc
