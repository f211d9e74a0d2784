// EdgePairFinder: the paths of a link over two edges in a row, as lists of what they meet.
//
// As EdgeFinder: a way to the first edge from one end and a way from the second edge to the other,
// over images, make a path that bends at both where it is shortest. Between the edges nothing
// reflects. Two edges of one face are joined by it: the way goes along it, on a sheet along both
// sides (two paths). The depth counts both edges.
//
// Not found are ways between edges whose faces are in one plane and touch, and what EdgeFinder does
// not find.
//
// Takes time as the number of edges squared.
//
// Thread safety: one finder a thread (it holds scratch memory).
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
        const std::vector<Between> ways = ways_between(first, second);
        for (const LitEdge& from : transmitter.of(first)) {
          for (const LitEdge& to : receiver.of(second)) {
            for (const Between& between : ways) {
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

  // Along which face of the first edge that both share the way goes: true for its face n, false for
  // face 0; nothing: through space.
  using Between = std::optional<bool>;

  // False where geometry proves that no way goes from the one to the other.
  bool may_follow(std::uint32_t first, std::uint32_t second) const;
  std::vector<Between> ways_between(std::uint32_t first, std::uint32_t second) const;
  // Fills interactions_; false when there is no such path.
  bool find(const Pair& pair, const LitWay& from, const LitWay& to, const Between& between);
  // Fill between_; false where something is in the way.
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
