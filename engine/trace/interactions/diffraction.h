// Diffraction: the wave turns at the edge of a wedge.
//
// Found between what both ends light of an edge (diffraction/edge_finder.h). What becomes of the
// wave depends on both ends of the whole way, so diffraction/edge_path.h carries it over the edge.
#pragma once

#include "engine/base/check.h"
#include "engine/trace/interactions/wave.h"

namespace rayloc::interactions {

struct Diffraction {
  static constexpr char kLetter = 'D';         // as reports write it
  static constexpr bool kIsMirror = false;     // is_mirror() of this kind
  static constexpr bool kGoesThrough = false;  // goes_through() of this kind
  static constexpr bool kIsEdge = true;        // is_edge() of this kind

  // Not for a single face: paths over edges go by edge_path().
  template <typename T>
  static Wave<T> apply(const Wave<T>& /*in*/, const Facet<T>& /*facet*/, const T& /*wavelength*/) {
    check_failed("a path over an edge goes by edge_path()", __FILE__, __LINE__);
  }
};

}  // namespace rayloc::interactions
