// EdgeSide: the way between an end and where a path bends at an edge, over the mirrors of a
// LitEdge.
//
// Thread safety: one a thread (it holds scratch memory).
#pragma once

#include <memory>
#include <vector>

#include "engine/scene/wedges.h"
#include "engine/trace/diffraction/lit_edges.h"
#include "engine/trace/images/image_tree.h"
#include "engine/trace/interaction_finder.h"
#include "engine/trace/path.h"
#include "engine/trace/trace_context.h"

namespace rayloc {

// Faces may be so far off the edge that they meet at, twice the tolerance of meshes [m]. What is in
// the way is looked for as far outside of the wedge: its own faces are not.
inline constexpr double kOffEdge = 2e-5;

// REQUIRES: the bend is on the edge.
Vec3d beside_edge(const Wedge& wedge, const Vec3d& bend);

// As a path has it, where it bends at an edge.
Interaction turn_at(const TraceContext& context, std::uint32_t edge, const Vec3d& bend);

// How an end lights a part of an edge.
struct LitWay {
  const LitEdge& lit;
  const LitEdges& end;
};

class EdgeSide {
 public:
  explicit EdgeSide(std::shared_ptr<const TraceContext> context) : finder_(std::move(context)) {}

  // Whether the mirrors are where the way to the bend wants them.
  bool trace(const LitWay& way, const Vec3d& bend);
  // Whether the way to a point beside the edge is free; fills met(). REQUIRES: trace().
  bool find(const LitWay& way, const Vec3d& beside);
  // From the bend to the end.
  const std::vector<Interaction>& met() const { return met_; }

 private:
  InteractionFinder finder_;
  SpecularChain chain_;  // from the end on
  std::vector<Interaction> met_;
};

}  // namespace rayloc
