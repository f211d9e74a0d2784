// Diffraction: the wave bends at the edge of a wedge.
//
// Candidates are edges that both ends light (diffraction/edge_finder.h). The field behind the edge
// depends on both ends of the whole path, so diffraction/edge_path.h computes it.
#pragma once

#include "engine/base/check.h"
#include "engine/trace/interactions/wave.h"

namespace rayloc::interactions {

struct Diffraction {
  static constexpr char kLetter = 'D';         // used in reports
  static constexpr bool kIsMirror = false;     // is_mirror() of this kind
  static constexpr bool kGoesThrough = false;  // goes_through() of this kind
  static constexpr bool kIsEdge = true;        // is_edge() of this kind

  // Undefined for a single face: paths over edges use edge_path().
  template <typename T>
  static Wave<T> apply(const Wave<T>& /*in*/, const Facet<T>& /*facet*/, const T& /*wavelength*/) {
    check_failed("a path over an edge goes by edge_path()", __FILE__, __LINE__);
  }
};

}  // namespace rayloc::interactions
