// Shadowing: the wave passes the edge of an opaque surface, under soft visibility.
//
// It is found where a segment between two mirrors meets a face or its soft edge, without
// transmission (TraceContext::crossings). With hard edges a face stops the wave or is not met.
#pragma once

#include "engine/trace/interactions/wave.h"

namespace rayloc::interactions {

struct Shadowing {
  static constexpr char kLetter = 'S';         // used in reports
  static constexpr bool kIsMirror = false;     // is_mirror() of this kind
  static constexpr bool kGoesThrough = false;  // goes_through() of this kind
  static constexpr bool kIsEdge = false;       // is_edge() of this kind

  // The wave is unchanged; the weight of the edge gives the share that passes (soft_path.h).
  template <typename T>
  static Wave<T> apply(const Wave<T>& in, const Facet<T>& /*facet*/, const T& /*wavelength*/) {
    return in;
  }
};

}  // namespace rayloc::interactions
