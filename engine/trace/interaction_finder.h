// InteractionFinder: finds all interactions of the path over a chain of mirrors: the points of
// reflection and the crossings between them.
//
// Thread safety: one finder per thread (it holds scratch memory).
#pragma once

#include <memory>
#include <vector>

#include "engine/trace/images/image_tree.h"
#include "engine/trace/path.h"
#include "engine/trace/soft_path.h"
#include "engine/trace/trace_context.h"

namespace rayloc {

class InteractionFinder {
 public:
  explicit InteractionFinder(std::shared_ptr<const TraceContext> context)
      : context_(std::move(context)) {}

  // `chain` begins at the receiver (the root of the tree), `interactions` at the transmitter. False
  // when there is no path: blocked, or more interactions than the depth allows.
  bool find(const SpecularChain& chain,
            const LinkEnd<double>& transmitter,
            const LinkEnd<double>& receiver,
            std::vector<Interaction>& interactions);

 private:
  Interaction interaction(InteractionKind kind, std::uint32_t surface, const Vec3d& at) const;
  bool add_crossings(const Segment& segment, std::vector<Interaction>& interactions);
  // Adds a reflection of a wave that comes from `from`, with the coincident faces that the wave
  // passes through, in both directions (coplanar_faces.h).
  bool add_reflection(const Interaction& mirror,
                      const Vec3d& from,
                      std::vector<Interaction>& interactions);
  double weight_at(std::uint32_t number, const Vec3d& point) const;
  bool add_soft_crossings(const SoftPath<double>& path,
                          std::size_t index,
                          const Segment& segment,
                          std::vector<Interaction>& interactions);
  bool find_soft(const LinkEnd<double>& transmitter,
                 const LinkEnd<double>& receiver,
                 std::vector<Interaction>& interactions);

  std::shared_ptr<const TraceContext> context_;
  std::vector<Crossing> crossings_;
  std::vector<Interaction> mirrors_;
  std::vector<SoftInteraction<double>> soft_mirrors_;
  std::size_t certain_ = 0;  // interactions of weight 1 so far
};

}  // namespace rayloc
