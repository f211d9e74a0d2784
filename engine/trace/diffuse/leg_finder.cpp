#include "engine/trace/diffuse/leg_finder.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace rayloc {
namespace {

// [m], twice the tolerance of meshes, as beside an edge.
constexpr double kBeside = 2e-5;
// A cosine, chosen: a leg nearer to grazing carries no power.
constexpr double kMinLegCosine = 1e-6;
// A count, chosen: faces in front of a mirror that the path to it crosses, a wall or a door.
constexpr int kMaxCrossed = 2;

std::shared_ptr<const ImageTree> tree_at(const TraceContext& context,
                                         const Vec3d& end,
                                         int most_mirrors) {
  TraceOptions options = context.options;
  options.max_depth = most_mirrors;
  if (options.transmission && most_mirrors > 0) {
    // The tree omits a mirror behind more faces than its depth allows to cross.
    options.max_depth =
        std::max(most_mirrors, std::min(context.options.max_depth - 1, most_mirrors + kMaxCrossed));
  }
  return std::make_shared<const ImageTree>(*context.scene, end, options);
}

}  // namespace

LegFinder::LegFinder(std::shared_ptr<const TraceContext> context,
                     const Vec3d& end,
                     int most_mirrors)
    : context_(context),
      end_(end),
      most_mirrors_(static_cast<std::size_t>(most_mirrors)),
      tree_(tree_at(*context, end, most_mirrors)),
      finder_(std::move(context)) {}

const std::vector<FoundLeg>& LegFinder::find(const Vec3d& point, const Vec3d& side) {
  legs_.clear();
  LinkEnd<double> from;
  from.position = point + kBeside * side;
  LinkEnd<double> to;
  to.position = end_;
  const auto is_in_patch = [&](std::uint32_t mirror) {
    return std::abs(distance(context_->facets[mirror].plane, point)) < kBeside;
  };
  tree_->visit_chains(0, from.position, [&](const SpecularChain& chain) {
    if (chain.surfaces.size() > most_mirrors_ ||
        (!chain.surfaces.empty() && is_in_patch(chain.surfaces.back()))) {
      return;
    }
    const Vec3d last = (chain.points.empty() ? end_ : chain.points.back()) - point;
    if (dot(last, side) > kMinLegCosine * norm(last) && finder_.find(chain, from, to, met_)) {
      legs_.push_back({{met_.rbegin(), met_.rend()}, static_cast<int>(chain.points.size())});
    }
  });
  return legs_;
}

}  // namespace rayloc
