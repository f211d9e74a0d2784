// TraceOptions: which paths a tracer looks for.
#pragma once

#include <cstdint>

namespace rayloc {

inline constexpr int kDefaultMaxDepth = 3;

struct TraceOptions {
  // Reflections, and with `transmission` crossings of faces too: a wall of two faces is two.
  int max_depth = kDefaultMaxDepth;
  // Waves also go straight on through objects. Else every surface is opaque.
  bool transmission = false;
  // Over what distance from its edge a surface begins to reflect and to shadow [m] (visibility.h);
  // 0: at the edge, as real surfaces of the geometrical optics do.
  double softness = 0.0;
};

}  // namespace rayloc
