#include "engine/trace/scattering/scattering_end.h"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

#include "engine/trace/image_method.h"

namespace rayloc {
namespace {

constexpr double kSameImage = 1e-9;  // [m]

bool fewer_mirrors_first(const SpecularChain& a, const SpecularChain& b) {
  return std::make_tuple(a.surfaces.size(), std::cref(a.surfaces)) <
         std::make_tuple(b.surfaces.size(), std::cref(b.surfaces));
}

}  // namespace

ScatteringEnd::ScatteringEnd(std::shared_ptr<const TraceContext> context, const RadioDevice& device)
    : context_(std::move(context)),
      device_(device),
      end_(link_end(device)),
      tree_(*context_->scene, device.position, context_->options) {}

std::vector<MirrorChains> ScatteringEnd::chains_to(const TargetPosition& position,
                                                   std::span<const double> heights) const {
  std::vector<SpecularChain> all;
  std::vector<SpecularChain> found;
  for (const double z : heights) {
    const std::size_t count = tree_.chains_to({position.x, position.y, z}, found);
    all.insert(all.end(), found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count));
  }
  std::sort(all.begin(), all.end(), fewer_mirrors_first);
  const auto same = [](const SpecularChain& a, const SpecularChain& b) {
    return a.surfaces == b.surfaces;
  };
  all.erase(std::unique(all.begin(), all.end(), same), all.end());

  std::vector<MirrorChains> groups;
  for (SpecularChain& chain : all) {
    Vec3d image = device_.position;
    for (const std::uint32_t surface : chain.surfaces) {
      image = mirror(context_->facets[surface].plane, image);
    }
    const auto known = std::find_if(groups.begin(), groups.end(), [&](const MirrorChains& group) {
      return group.chains.front().surfaces.size() == chain.surfaces.size() &&
             norm(group.image - image) < kSameImage;
    });
    // Each of two coincident mirrors has its share of a wave where both count.
    const bool all_count = context_->options.softness > 0.0 || context_->options.transmission;
    if (known == groups.end() || all_count) {
      groups.push_back({image, {std::move(chain)}});
    } else {
      known->chains.push_back(std::move(chain));
    }
  }
  return groups;
}

bool ScatteringEnd::find(MirrorChains& chains,
                         const Vec3d& point,
                         InteractionFinder& finder,
                         std::vector<Interaction>& interactions) const {
  const LinkEnd<double> probe{point, AntennaPattern::kIsotropic, Polarization::kVertical, {}};
  const bool opaque = !context_->options.transmission && context_->options.softness == 0.0;
  return std::any_of(chains.chains.begin(), chains.chains.end(), [&](SpecularChain& chain) {
    return retrace(chain, point) && (!opaque || is_clear(chain, point)) &&
           finder.find(chain, probe, end_, interactions);
  });
}

// Backwards from the point, over the images of the device.
bool ScatteringEnd::retrace(SpecularChain& chain, const Vec3d& point) const {
  std::vector<Vec3d> images{device_.position};
  for (const std::uint32_t surface : chain.surfaces) {
    images.push_back(mirror(context_->facets[surface].plane, images.back()));
  }
  chain.points.resize(chain.surfaces.size());
  Vec3d from = point;
  for (std::size_t i = chain.surfaces.size(); i > 0; --i) {
    const Surface& surface = context_->scene->surfaces()[chain.surfaces[i - 1]];
    const double here = distance(surface.plane(), from);
    const double there = distance(surface.plane(), images[i]);
    if (!(here * there < 0.0)) {
      return false;
    }
    from = meet(surface.plane(), from, images[i]);
    if (!surface.contains(from, context_->options.softness)) {
      return false;
    }
    chain.points[i - 1] = from;
  }
  return true;
}

bool ScatteringEnd::is_clear(const SpecularChain& chain, const Vec3d& point) const {
  Segment segment{device_.position, device_.position, kNoSurface, kNoSurface};
  for (std::size_t i = 0; i <= chain.points.size(); ++i) {
    const bool last = i == chain.points.size();
    segment.to = last ? point : chain.points[i];
    segment.to_surface = last ? kNoSurface : chain.surfaces[i];
    if (context_->scene->is_blocked(segment)) {
      return false;
    }
    segment.from = segment.to;
    segment.from_surface = segment.to_surface;
  }
  return true;
}

}  // namespace rayloc
