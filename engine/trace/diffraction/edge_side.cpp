#include "engine/trace/diffraction/edge_side.h"

#include <cmath>
#include <numbers>

#include "engine/trace/field_calculator.h"

namespace rayloc {

Vec3d beside_edge(const Wedge& wedge, const Vec3d& bend) {
  const double middle = 0.5 * wedge.n * std::numbers::pi;
  return bend + kOffEdge * (std::cos(middle) * wedge.in_face + std::sin(middle) * wedge.normal);
}

Interaction turn_at(const TraceContext& context, std::uint32_t edge, const Vec3d& bend) {
  const Wedge& wedge = context.wedges[edge];
  Interaction turn{
      InteractionKind::kDiffraction, context.scene->owner(wedge.face_0).object, wedge.face_0, bend};
  turn.edge = edge;
  return turn;
}

bool EdgeSide::trace(const LitRoute& route, const Vec3d& bend) {
  chain_.surfaces.clear();
  chain_.points.clear();
  return route.lit.node == kRootNode ||
         route.end.tree().back_trace(route.end.root(), route.lit.node, bend, chain_);
}

bool EdgeSide::find(const LitRoute& route, const Vec3d& beside) {
  if (!route.end.tree().is_open(route.end.root(), chain_, beside)) {
    return false;
  }
  LinkEnd<double> at_bend;
  at_bend.position = beside;
  LinkEnd<double> at_end;
  at_end.position = route.end.end();
  return finder_.find(chain_, at_bend, at_end, met_) && met_.size() <= kMaxBesideEdge;
}

}  // namespace rayloc
