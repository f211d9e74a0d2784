// The baseline of shooting and bouncing rays: Embree, and nothing besides.
//
// Rays leave a point, are reflected by every triangle they meet and end after so many reflections
// or outside. Nothing is recorded. Among Embree's ways of taking rays (one by one, packets of 4, 8
// and 16, streams of structures, streams of arrays) and sizes from 64 to 4096, streams of 256 rays
// as arrays, in the lattice's order and declared coherent, are the fastest on AVX-512: three times
// one ray at a time (laboratory, robust, 262144 rays).
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "engine/scene/scene.h"

namespace rayloc::bench {

class BareShooting {
 public:
  // Aborts when Embree cannot work here.
  explicit BareShooting(const Scene& scene);
  ~BareShooting();
  BareShooting(const BareShooting&) = delete;
  BareShooting& operator=(const BareShooting&) = delete;

  using Directions = std::vector<std::vector<Vec3d>>;  // by the portion that a thread takes

  // How many segments the rays made. Threads: as many as TBB has.
  std::size_t shoot(const Vec3d& root, const Directions& directions, int max_depth) const;

 private:
  class Impl;
  std::unique_ptr<const Impl> impl_;
};

// The directions of the lattice, ring by ring.
BareShooting::Directions lattice_directions(std::size_t rays);

}  // namespace rayloc::bench
