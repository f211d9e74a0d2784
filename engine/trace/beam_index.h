// BeamIndex: which of many beams come by a point.
//
// A tree of cubes over the scene; each cube lists the beams that meet it, from the list of the cube
// around it. Cubes are made when somebody asks for a point in them, so that a single query costs
// little more than a look at every beam, and the next ones nearby hundreds of times less. What is
// found does not depend on which cubes are there.
//
// Thread safety: const members may be used from many threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/base/vec3.h"
#include "engine/scene/surface.h"

namespace rayloc {

// Half spaces that hold a beam, in single precision and relative to the root of its tree.
struct BeamBounds {
  static constexpr std::size_t kPlanes = 8;
  alignas(32) float x[kPlanes], y[kPlanes], z[kPlanes], offset[kPlanes];

  // The first kPlanes of `planes`.
  BeamBounds(std::span<const Plane<double>> planes, const Vec3d& root);

  // Whether a point at `from_root` is no further than `margin` outside each of the planes, or, with
  // `half` > 0, some point of the cube around it.
  bool meets(const Vec3<float>& from_root, float half, float margin) const;
};

class BeamIndex {
 public:
  // lower, upper: where points are looked for; others are found too, slowly.
  BeamIndex(std::vector<BeamBounds> beams,
            const Vec3d& root,
            const Vec3d& lower,
            const Vec3d& upper);

  // The numbers of the beams that hold the point, ascending, and some of others that it is near.
  // Fills `found`, whose memory is used again.
  void find(const Vec3d& point, std::vector<std::uint32_t>& found) const;

  std::size_t bytes() const;  // of the beams and of the cubes so far

 private:
  struct Cube {
    Vec3<float> centre;  // relative to the root [m]
    float half = 0.0F;
    bool is_leaf = false;
    std::vector<std::uint32_t> beams;
    std::array<Lazy<Cube>, 8> parts;
  };

  std::unique_ptr<const Cube> part(const Cube& whole, std::size_t octant) const;
  static std::size_t bytes(const Cube& cube);

  std::vector<BeamBounds> beams_;
  Vec3d root_;
  float reach_;  // the largest coordinate relative to the root [m]
  Cube all_;
};

}  // namespace rayloc
