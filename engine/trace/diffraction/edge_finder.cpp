#include "engine/trace/diffraction/edge_finder.h"

#include <cstddef>

namespace rayloc {

bool EdgeFinder::find(std::uint32_t edge, const LitRoute& from, const LitRoute& to) {
  const auto most = static_cast<std::size_t>(context_->options.max_depth);
  if (from.lit.mirrors + to.lit.mirrors + 1 > most) {
    return false;
  }
  const double height = edge_height(from.lit.image, to.lit.image);
  const Wedge& wedge = context_->wedges[edge];
  if (height < from.lit.lower || height > from.lit.upper || height < to.lit.lower ||
      height > to.lit.upper || height <= 0.0 || height >= norm(wedge.to - wedge.from)) {
    return false;
  }
  const Vec3d bend = wedge.from + height * wedge.along;
  // Cheap tests come first.
  if (!before_.trace(from, bend) || !after_.trace(to, bend)) {
    return false;
  }
  const Vec3d beside = beside_edge(wedge, bend);
  if (!before_.find(from, beside) || !after_.find(to, beside) ||
      before_.met().size() + after_.met().size() + 1 > most) {
    return false;
  }
  interactions_.assign(before_.met().rbegin(), before_.met().rend());
  interactions_.push_back(turn_at(*context_, edge, bend));
  interactions_.insert(interactions_.end(), after_.met().begin(), after_.met().end());
  return true;
}

}  // namespace rayloc
