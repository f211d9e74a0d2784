// EdgePairFinder: the paths of a link over two edges in a row, as lists of their interactions.
//
// As in EdgeFinder, a path to the first edge from one end and a path from the second edge to the
// other, over images, make a path whose bends minimise its length. Between the edges nothing
// reflects. Two edges of one face are joined by it: the path follows the face, on a sheet along
// both sides (two paths). The depth counts both edges.
//
// Paths between edges whose faces are in one plane and touch are not found, nor those that
// EdgeFinder does not find.
//
// The run time grows as the number of edges squared.
//
// Thread safety: one finder per thread (it holds scratch memory).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "engine/trace/diffraction/edge_pair.h"
#include "engine/trace/diffraction/edge_side.h"
#include "engine/trace/diffraction/lit_edges.h"
#include "engine/trace/interaction_finder.h"
#include "engine/trace/trace_context.h"

namespace rayloc {

class EdgePairFinder {
 public:
  explicit EdgePairFinder(std::shared_ptr<const TraceContext> context)
      : context_(context), before_(context), after_(context), finder_(std::move(context)) {}

  // Calls visit(const std::vector<Interaction>&) for every path, interactions from the transmitter
  // on; pair by pair.
  template <typename Visit>
  void visit(const LitEdges& transmitter, const LitEdges& receiver, const Visit& visit) {
    const auto edges = static_cast<std::uint32_t>(context_->wedges.size());
    for (std::uint32_t first = 0; first < edges; ++first) {
      for (std::uint32_t second = 0; second < edges; ++second) {
        if (transmitter.of(first).empty() || receiver.of(second).empty() ||
            !may_follow(first, second)) {
          continue;
        }
        const std::vector<Between> routes = routes_between(first, second);
        for (const LitEdge& from : transmitter.of(first)) {
          for (const LitEdge& to : receiver.of(second)) {
            for (const Between& between : routes) {
              if (find({first, second}, {from, transmitter}, {to, receiver}, between)) {
                visit(std::as_const(interactions_));
              }
            }
          }
        }
      }
    }
  }

 private:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  // The face of the first edge that both share and the path follows: true for its face n, false for
  // face 0; nothing: through space.
  using Between = std::optional<bool>;

  // False where geometry proves that no path leads from the first to the second.
  bool may_follow(std::uint32_t first, std::uint32_t second) const;
  std::vector<Between> routes_between(std::uint32_t first, std::uint32_t second) const;
  // Fills interactions_; false when there is no such path.
  bool find(const Pair& pair, const LitRoute& from, const LitRoute& to, const Between& between);
  // Fill between_; false where the path is obstructed.
  bool is_joined(const Wedge& first, const Vec3d& bend, const Vec3d& other, bool along_face_n);
  bool is_open(const Vec3d& from, const Vec3d& to);

  std::shared_ptr<const TraceContext> context_;
  EdgeSide before_;
  EdgeSide after_;
  InteractionFinder finder_;
  std::vector<Interaction> between_;
  std::vector<Interaction> interactions_;
};

}  // namespace rayloc
