// CoplanarFaces: faces of different objects at one place, such as a cupboard's and that of the
// floor which it stands on.
//
// Of such a pair the tracer must know which is met first. With transmission a wave meets both, as
// it would when they were a hair apart: reflected at the second it goes through the first, there
// and back, and may go to and fro between them (round_trips.h). So paths are those of the limit in
// which the gap between the two goes to zero; with soft edges (visibility.h) those without round
// trips. Without transmission one of the two acts: that of the lower number.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/scene/scene.h"
#include "engine/trace/trace_options.h"

namespace rayloc {

// A face at the place of another one.
struct CoplanarFace {
  std::uint32_t surface = 0;
  // On which side of the other it lies: +1 that to which the other's normal points, -1 the opposite
  // one. Closed objects are drawn back from each other into themselves and from sheets; of two that
  // face the same way the larger face is outside (things stand in rooms), and of two sheets that of
  // the lower number lies where its normal points to.
  int side = 0;
};

// For each surface the others of other objects that lie in its plane and touch it, by number.
std::vector<std::vector<CoplanarFace>> find_coplanar_faces(const Scene& scene,
                                                           const TraceOptions& options);

}  // namespace rayloc
