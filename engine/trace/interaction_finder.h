// InteractionFinder: from a chain of mirrors to all that its path meets: the points of reflection
// and, between them, what the wave crosses.
//
// Thread safety: one finder a thread (it holds scratch memory).
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

  // `chain` begins at the receiver (the root of the tree), `interactions` at the transmitter.
  // False when no path is left: blocked, or more interactions than the depth allows.
  bool find(const SpecularChain& chain,
            const LinkEnd<double>& transmitter,
            const LinkEnd<double>& receiver,
            std::vector<Interaction>& interactions);

 private:
  Interaction interaction(InteractionKind kind, std::uint32_t surface, const Vec3d& at) const;
  bool add_crossings(const Segment& segment, std::vector<Interaction>& interactions);
  // A reflection of a wave that comes from `from`, with the faces at the same place that it goes
  // through, there and back (coplanar_faces.h).
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
