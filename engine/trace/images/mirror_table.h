// MirrorTable: the surfaces of a scene as mirrors for waves from some points, laid out so that a
// beam finds those that it may light without looking at each closely.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/trace/images/beam.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

class MirrorTable {
 public:
  // All surfaces of the scene, which must outlive the table.
  MirrorTable(const Scene& scene, std::span<const Vec3d> roots, const TraceOptions& options);
  // Only those of some objects; the others are not asked for.
  MirrorTable(const Scene& scene,
              std::span<const Vec3d> roots,
              const TraceOptions& options,
              std::span<const std::uint32_t> objects);

  // The first root: what single precision is relative to.
  const Vec3d& reference() const { return roots_.front(); }

  const Plane<double>& plane(std::uint32_t surface) const {
    return scene_->surfaces()[surface].plane();
  }
  // Of the mirror: the surface's, a little larger (kBeamMargin and the softness).
  const Polygon& outline(std::uint32_t surface) const { return outlines_[surface]; }

  // Whether waves from a root can come to a face from the side where `image_distance`, the signed
  // distance of a point from its plane, says that they come from.
  bool is_lit(std::uint32_t surface, std::size_t root, double image_distance) const {
    return image_distance * side_[surface * roots_.size() + root] >= 0.0;
  }

  // The surfaces, ascending and of the whole scene, of which no bound cuts off all. Some others are
  // among them: single precision with a margin decides. Fills `found`, whose memory is used again.
  void find(std::span<const Plane<double>> bounds, std::vector<std::uint32_t>& found) const;

 private:
  // A count of surfaces, chosen: 16 floats fill a cache line of 64 bytes.
  static constexpr std::size_t kBlock = 16;
  using Lanes = std::array<float, kBlock>;

  // Single precision, relative to the first root.
  struct Vectors {
    alignas(64) Lanes x, y, z;
  };
  // The rectangles around outlines: centres and halves of their sides.
  struct Block {
    Vectors centre, half_u, half_v;
  };
  struct PlaneF {
    float x, y, z, offset;
  };

  void add_object(std::uint32_t object, const TraceOptions& options);
  void put_into_block(std::uint32_t surface);
  unsigned within(const Block& block, std::span<const PlaneF> bounds) const;

  const Scene* scene_;
  std::vector<Vec3d> roots_;
  double reach_ = 0.0;  // the largest coordinate, relative to the first root [m]
  std::vector<Polygon> outlines_;
  // Of each surface for each root. +1: that of the normal; -1: the other; 0: both.
  std::vector<std::int8_t> side_;
  std::vector<Block> blocks_;
};

}  // namespace rayloc
