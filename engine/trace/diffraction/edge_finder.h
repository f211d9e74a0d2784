// EdgeFinder: the paths of a link over one edge, as lists of their interactions.
//
// A path to the edge from each end, over images (lit_edges.h), makes one path: its bend follows
// from Fermat's principle. Up to kMaxBesideEdge interactions lie on each side, no more than the
// depth in total. The bend must be on the edge, and both parts must be unobstructed; each is
// searched like a path without an edge (interaction_finder.h).
//
// Paths that bend at corners where an edge ends, and paths from within a wedge are not found. For
// paths that bend twice see edge_pair_finder.h.
//
// Thread safety: one finder per thread (it holds scratch memory).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/trace/diffraction/edge_side.h"
#include "engine/trace/diffraction/lit_edges.h"
#include "engine/trace/path.h"
#include "engine/trace/trace_context.h"

namespace rayloc {

class EdgeFinder {
 public:
  explicit EdgeFinder(std::shared_ptr<const TraceContext> context)
      : context_(context), before_(context), after_(std::move(context)) {}

  // Calls visit(const std::vector<Interaction>&) for every path, interactions from the transmitter
  // on; edge by edge.
  template <typename Visit>
  void visit(const LitEdges& transmitter, const LitEdges& receiver, const Visit& visit) {
    for (std::uint32_t edge = 0; edge < context_->wedges.size(); ++edge) {
      for (const LitEdge& from : transmitter.of(edge)) {
        for (const LitEdge& to : receiver.of(edge)) {
          if (find(edge, {from, transmitter}, {to, receiver})) {
            visit(std::as_const(interactions_));
          }
        }
      }
    }
  }

 private:
  // Fills interactions_; false when there is no such path.
  bool find(std::uint32_t edge, const LitRoute& from, const LitRoute& to);

  std::shared_ptr<const TraceContext> context_;
  EdgeSide before_;
  EdgeSide after_;
  std::vector<Interaction> interactions_;
};

}  // namespace rayloc
