// BeamIndex: finds the beams near a point among many.
//
// A tree of cubes over the scene; each cube lists the beams that meet it, selected from the list
// of the enclosing cube. Cubes are made on the first query of a point in them, so that a single
// query costs little more than a test of every beam, and later ones nearby hundreds of times less.
// A cube that is queried often is refined once: beams that the caller rejects in all of it are
// left out from then on.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/kept.h"
#include "engine/base/vec3.h"
#include "engine/scene/surface.h"

namespace rayloc {

// A part of a segment, as fractions of its length from its start.
struct SharesOfSegment {
  double first = 0.0;
  double last = 1.0;
};

// Half spaces that contain a beam, in single precision and relative to the root of its tree.
struct BeamBounds {
  static constexpr std::size_t kPlanes = 8;  // a count, chosen: a register of eight floats (AVX2)
  using Lanes = std::array<float, kPlanes>;
  alignas(32) Lanes x, y, z, offset;

  // Uses the first kPlanes of `planes`.
  BeamBounds(std::span<const Plane<double>> planes, const Vec3d& root);

  // True if a point at `from_root` is no further than `margin` outside each of the planes, or, with
  // `half` > 0, some point of the cube around it.
  bool meets(const Vec3<float>& from_root, float half, float margin) const;
  // The same test for some point of a box around it.
  bool meets(const Vec3<float>& from_root, const Vec3<float>& half, float margin) const;
  // The same test for some point of a segment; `part` then contains such points.
  bool meets(const Vec3<float>& from,
             const Vec3<float>& to,
             float margin,
             SharesOfSegment& part) const;
};

// The points that differ from `centre` by no more than `half` in each coordinate [m], world.
struct CubeRegion {
  Vec3d centre;
  double half;
};

class BeamIndex {
 public:
  // The box of expected queries (others are answered too, slowly), and the number of queries of one
  // cube after which its refinement pays off.
  struct Region {
    Vec3d lower;
    Vec3d upper;
    std::uint32_t often;
  };
  BeamIndex(std::vector<BeamBounds> beams, const Vec3d& root, const Region& region);

  // The numbers of the beams that contain the point, ascending, and some of others nearby. Fills
  // `found`, whose memory is reused. is_vain(beam, CubeRegion): true if the caller has no use for
  // the beam anywhere in the region; such beams may be included or not.
  template <typename IsVain>
  void find(const Vec3d& point, std::vector<std::uint32_t>& found, const IsVain& is_vain) const {
    const Cube* cube = cube_at(point);
    if (cube == nullptr) {
      select(point, all_.beams, found);
      return;
    }
    cube->asked.add();
    if (cube->asked.count() <= often_) {
      select(point, cube->beams, found);
      return;
    }
    select(point,
           cube->useful.get([&] {
             auto useful = std::make_unique<std::vector<std::uint32_t>>();
             const CubeRegion region = region_of(*cube);
             for (const std::uint32_t beam : cube->beams) {
               if (!is_vain(beam, region)) {
                 useful->push_back(beam);
               }
             }
             return useful;
           }),
           found);
  }

  // In single precision, relative to the root.
  struct Segment {
    Vec3<float> from, to;
    float margin;
  };
  struct Box {
    Vec3<float> centre, half;
    float margin;
  };
  Segment segment(const Vec3d& from, const Vec3d& to) const;
  Box box(const Vec3d& lower, const Vec3d& upper) const;
  // True if a beam contains some point of it, or is near one; those of a segment are within `part`.
  bool meets(std::uint32_t beam, const Segment& segment, SharesOfSegment& part) const {
    return beams_[beam].meets(segment.from, segment.to, segment.margin, part);
  }
  bool meets(std::uint32_t beam, const Box& box) const {
    return beams_[beam].meets(box.centre, box.half, box.margin);
  }

  std::size_t bytes() const;  // memory of the beams and of the cubes so far

 private:
  struct Cube {
    Vec3<float> centre;  // relative to the root [m]
    float half = 0.0F;
    bool is_leaf = false;
    std::vector<std::uint32_t> beams;
    std::array<Lazy<Cube>, 8> parts;
    Tally asked;
    Lazy<std::vector<std::uint32_t>> useful;
  };
  // A refinement costs as much as some five queries save.
  static constexpr std::uint32_t kOften = 4;

  const Cube* cube_at(const Vec3d& point) const;  // the smallest cube; nullptr outside of all cubes
  CubeRegion region_of(const Cube& cube) const;
  void select(const Vec3d& point,
              std::span<const std::uint32_t> from,
              std::vector<std::uint32_t>& found) const;
  std::unique_ptr<const Cube> part(const Cube& whole, std::size_t octant) const;
  static std::size_t bytes(const Cube& cube);
  Vec3<float> from_root(const Vec3d& point) const;

  std::vector<BeamBounds> beams_;
  Vec3d root_;
  std::uint32_t often_;
  float reach_;  // the largest coordinate relative to the root [m]
  Cube all_;
};

}  // namespace rayloc
