// MirrorTable: the surfaces of a scene as mirrors for waves from some points, in a layout that lets
// a beam find those that it may light without a close test of each.
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
  // Only those of some objects; the others are never requested.
  MirrorTable(const Scene& scene,
              std::span<const Vec3d> roots,
              const TraceOptions& options,
              std::span<const std::uint32_t> objects);

  // The first root: the reference point of single-precision coordinates.
  const Vec3d& reference() const { return roots_.front(); }

  const Plane<double>& plane(std::uint32_t surface) const {
    return scene_->surfaces()[surface].plane();
  }
  // Outline of the mirror: the surface's, enlarged by kBeamMargin and the softness.
  const Polygon& outline(std::uint32_t surface) const { return outlines_[surface]; }

  // True if waves from a root can reach a face from the side given by the sign of `image_distance`,
  // the signed distance of their apparent source from its plane.
  bool is_lit(std::uint32_t surface, std::size_t root, double image_distance) const {
    return image_distance * side_[surface * roots_.size() + root] >= 0.0;
  }

  // The surfaces, ascending and of the whole scene, that no bound removes completely. Some others
  // are included: single precision with a margin decides. Fills `found`, whose memory is reused.
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
  // Lit side of each surface for each root. +1: that of the normal; -1: the other; 0: both.
  std::vector<std::int8_t> side_;
  std::vector<Block> blocks_;
};

}  // namespace rayloc
