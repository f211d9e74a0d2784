// CoplanarFaces: coincident faces of different objects, such as those of a cupboard and of
// the floor under it.
//
// The tracer needs the order of such a pair. With transmission a wave meets both, as it would with
// a small gap between them: reflected at the second it passes through the first twice, and may
// bounce repeatedly between them (round_trips.h). So paths are those of the limit in which the gap
// between the two goes to zero; with soft edges (visibility.h) those without round trips. Without
// transmission only one of the two acts: that of the lower number.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

// A face that coincides with another one.
struct CoplanarFace {
  std::uint32_t surface = 0;
  // The side of the other face on which it lies: +1 the side of the other's normal, -1 the opposite
  // one. Closed objects are drawn back from each other into themselves and from sheets; of two with
  // the same normal the larger face is outside (objects are placed in rooms), and of two sheets
  // that of the lower number lies on the side of its normal.
  int side = 0;
};

// For each surface the surfaces of other objects that lie in its plane and touch it, by number.
std::vector<std::vector<CoplanarFace>> find_coplanar_faces(const Scene& scene,
                                                           const TraceOptions& options);

}  // namespace rayloc
