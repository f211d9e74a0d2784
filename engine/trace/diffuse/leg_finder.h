// LegFinder: the paths from one antenna to a point of a surface, as lists of interactions.
//
// The number of mirrors is limited by an argument. Obstructions are searched beside the point, as
// for edges (diffraction/edge_finder.h): a face does not obstruct itself.
//
// Thread safety: one finder per thread (it holds scratch memory).
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "engine/trace/images/image_tree.h"
#include "engine/trace/interaction_finder.h"
#include "engine/trace/path.h"
#include "engine/trace/trace_context.h"

namespace rayloc {

struct FoundLeg {
  std::vector<Interaction> interactions;  // from the end on
  int mirrors = 0;
};

class LegFinder {
 public:
  LegFinder(std::shared_ptr<const TraceContext> context, const Vec3d& end, int most_mirrors);

  // `side`: the unit normal of the surface, on the requested side.
  const std::vector<FoundLeg>& find(const Vec3d& point, const Vec3d& side);

 private:
  std::shared_ptr<const TraceContext> context_;
  Vec3d end_;
  std::size_t most_mirrors_;
  std::shared_ptr<const ImageTree> tree_;
  InteractionFinder finder_;
  std::vector<Interaction> met_;
  std::vector<FoundLeg> legs_;
};

}  // namespace rayloc
