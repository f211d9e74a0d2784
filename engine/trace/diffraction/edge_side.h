// EdgeSide: the path between an end and the bend at an edge, over the
// mirrors of a LitEdge.
//
// Thread safety: one per thread (it holds scratch memory).
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

// Maximum distance of faces from the edge at which they meet, twice the tolerance of meshes [m].
// Obstructions are searched from a point this far outside of the wedge, to exclude its own faces.
inline constexpr double kOffEdge = 2e-5;

// REQUIRES: the bend is on the edge.
Vec3d beside_edge(const Wedge& wedge, const Vec3d& bend);

// The interaction of a path that bends at an edge.
Interaction turn_at(const TraceContext& context, std::uint32_t edge, const Vec3d& bend);

// The mirrors over which an end lights a part of an edge.
struct LitRoute {
  const LitEdge& lit;
  const LitEdges& end;
};

class EdgeSide {
 public:
  explicit EdgeSide(std::shared_ptr<const TraceContext> context) : finder_(std::move(context)) {}

  // True if the mirrors reflect at the points that the path to the bend needs.
  bool trace(const LitRoute& route, const Vec3d& bend);
  // True if the path to a point beside the edge is unobstructed; fills met(). REQUIRES: trace().
  bool find(const LitRoute& route, const Vec3d& beside);
  // Interactions from the bend to the end.
  const std::vector<Interaction>& met() const { return met_; }

 private:
  InteractionFinder finder_;
  SpecularChain chain_;  // from the end on
  std::vector<Interaction> met_;
};

}  // namespace rayloc
