// The baseline of finding paths where few surfaces are to be tried: the image method as textbooks
// have it.
//
// Every sequence of mirrors that face the image before, each image mirrored once for all that
// follow it; then the points of reflection, and a test of occlusion between them. No beams, no
// tree, no fields.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/scene/scene.h"

namespace rayloc::bench {

class PlainImageMethod {
 public:
  // The scene must outlive it. REQUIRES: 0 <= max_depth <= kMaxDepth.
  PlainImageMethod(const Scene& scene, int max_depth);

  // How many paths there are; both ends outside of everything closed.
  std::size_t count_paths(const Vec3d& from, const Vec3d& to) const;

  static constexpr int kMaxDepth = 8;

 private:
  struct Chain;

  std::size_t follow(Chain& chain, int depth) const;
  bool is_path(const Chain& chain, int depth) const;

  const Scene& scene_;
  int max_depth_;
  std::vector<double> side_;  // of each surface that waves meet: +1 that of the normal; 0: both
};

}  // namespace rayloc::bench
