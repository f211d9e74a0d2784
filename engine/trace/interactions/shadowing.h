// Shadowing: the wave goes past the edge of an opaque surface, under soft visibility.
//
// Found where a segment between two mirrors meets a face or its soft edge, without transmission
// (TraceContext::crossings). Where edges are hard a face stops the wave or is not met.
#pragma once

#include "engine/trace/interactions/wave.h"

namespace rayloc::interactions {

struct Shadowing {
  static constexpr char kLetter = 'S';         // as reports write it
  static constexpr bool kIsMirror = false;     // is_mirror() of this kind
  static constexpr bool kGoesThrough = false;  // goes_through() of this kind
  static constexpr bool kIsEdge = false;       // is_edge() of this kind

  // The wave stays as it is; how much of it passes is the weight of the edge (soft_path.h).
  template <typename T>
  static Wave<T> apply(const Wave<T>& in, const Facet<T>& /*facet*/, const T& /*wavelength*/) {
    return in;
  }
};

}  // namespace rayloc::interactions
