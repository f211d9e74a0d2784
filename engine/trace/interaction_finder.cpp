#include "engine/trace/interaction_finder.h"

#include <algorithm>
#include <cstddef>

namespace rayloc {

Interaction InteractionFinder::interaction(InteractionKind kind,
                                           std::uint32_t surface,
                                           const Vec3d& at) const {
  return {kind, context_->scene->owner(surface).object, surface, at, 1.0};
}

bool InteractionFinder::find(const SpecularChain& chain,
                             const LinkEnd<double>& transmitter,
                             const LinkEnd<double>& receiver,
                             std::vector<Interaction>& interactions) {
  const TraceOptions& options = context_->options;
  interactions.clear();
  const bool as_is = !options.transmission && options.softness == 0.0;
  std::vector<Interaction>& mirrors = as_is ? interactions : mirrors_;
  mirrors.clear();
  for (std::size_t i = chain.surfaces.size(); i > 0; --i) {
    mirrors.push_back(
        interaction(InteractionKind::kReflection, chain.surfaces[i - 1], chain.points[i - 1]));
  }
  if (as_is) {
    return true;  // the tree returns only clear chains
  }
  if (options.softness > 0.0) {
    return find_soft(transmitter, receiver, interactions);
  }
  Segment segment{transmitter.position, transmitter.position, kNoSurface, kNoSurface};
  certain_ = mirrors_.size();
  for (std::size_t i = 0; i <= mirrors_.size(); ++i) {
    const bool last = i == mirrors_.size();
    segment.to = last ? receiver.position : mirrors_[i].position;
    segment.to_surface = last ? kNoSurface : mirrors_[i].surface;
    if (!add_crossings(segment, interactions)) {
      return false;
    }
    if (!last && !add_reflection(mirrors_[i], segment.from, interactions)) {
      return false;
    }
    segment.from = segment.to;
    segment.from_surface = segment.to_surface;
  }
  return true;
}

bool InteractionFinder::add_crossings(const Segment& segment,
                                      std::vector<Interaction>& interactions) {
  context_->crossings(segment, crossings_);
  certain_ += crossings_.size();
  if (certain_ > static_cast<std::size_t>(context_->options.max_depth)) {
    return false;
  }
  for (const Crossing& crossing : crossings_) {
    if (context_->opaque[crossing.surface]) {
      return false;
    }
    interactions.push_back(
        interaction(InteractionKind::kTransmission,
                    crossing.surface,
                    segment.from + crossing.share * (segment.to - segment.from)));
  }
  return true;
}

bool InteractionFinder::add_reflection(const Interaction& mirror,
                                       const Vec3d& from,
                                       std::vector<Interaction>& interactions) {
  const TraceOptions& options = context_->options;
  const auto& surfaces = context_->scene->surfaces();
  const int side = distance(surfaces[mirror.surface].plane(), from) > 0.0 ? 1 : -1;
  const std::size_t first = interactions.size();
  for (const CoplanarFace& face : context_->coplanar_faces[mirror.surface]) {
    // A gap slightly wider than zero is already a crossing.
    const bool is_crossed =
        std::any_of(crossings_.begin(), crossings_.end(), [&](const Crossing& crossing) {
          return crossing.surface == face.surface;
        });
    if (face.side != side || is_crossed) {
      continue;
    }
    const double weight = weight_at(face.surface, mirror.position);
    if (weight == 0.0) {
      continue;
    }
    certain_ += weight == 1.0 ? 2 : 0;
    if (weight == 1.0 && (context_->opaque[face.surface] ||
                          certain_ > static_cast<std::size_t>(options.max_depth))) {
      return false;
    }
    interactions.push_back(
        interaction(InteractionKind::kTransmission, face.surface, mirror.position));
    interactions.back().weight = weight;
    interactions.back().at_mirror = true;
  }
  const std::size_t end = interactions.size();
  interactions.push_back(mirror);
  for (std::size_t i = end; i > first; --i) {
    interactions.push_back(interactions[i - 1]);
  }
  return true;
}

// Coverage weight of a surface at a point of its plane.
double InteractionFinder::weight_at(std::uint32_t number, const Vec3d& point) const {
  const Surface& surface = context_->scene->surfaces()[number];
  const double softness = context_->options.softness;
  if (softness > 0.0) {
    return edge_weight(surface, context_->facets[number], point, softness);
  }
  return surface.contains(point) ? 1.0 : 0.0;
}

bool InteractionFinder::find_soft(const LinkEnd<double>& transmitter,
                                  const LinkEnd<double>& receiver,
                                  std::vector<Interaction>& interactions) {
  soft_mirrors_.clear();
  for (const Interaction& mirror : mirrors_) {
    soft_mirrors_.push_back(soft_interaction<double>(
        *context_, InteractionKind::kReflection, mirror.surface, [&](std::uint32_t surface) {
          return context_->facets[surface];
        }));
  }
  const SoftPath<double> path(
      soft_mirrors_, transmitter, receiver, context_->wavelength, context_->options);
  const double weight = path.mirror_weight();
  if (weight == 0.0) {
    return false;
  }
  certain_ = mirrors_.size();
  for (std::size_t i = 0; i <= mirrors_.size(); ++i) {
    const Segment segment{path.vertices()[i],
                          path.vertices()[i + 1],
                          i == 0 ? kNoSurface : mirrors_[i - 1].surface,
                          i == mirrors_.size() ? kNoSurface : mirrors_[i].surface};
    if (!add_soft_crossings(path, i, segment, interactions)) {
      return false;
    }
    if (i < mirrors_.size()) {
      // Factors of corners and ends belong to no single mirror; they are not separated here.
      mirrors_[i].weight = edge_weight(*soft_mirrors_[i].surface,
                                       soft_mirrors_[i].facet,
                                       path.vertices()[i + 1],
                                       context_->options.softness);
      if (!add_reflection(mirrors_[i], segment.from, interactions)) {
        return false;
      }
    }
  }
  return true;
}

bool InteractionFinder::add_soft_crossings(const SoftPath<double>& path,
                                           std::size_t index,
                                           const Segment& segment,
                                           std::vector<Interaction>& interactions) {
  const TraceOptions& options = context_->options;
  context_->crossings(segment, crossings_);
  for (const Crossing& crossing : crossings_) {
    const Vec3d point = segment.from + crossing.share * (segment.to - segment.from);
    const double weight = crossing_weight(context_->scene->surfaces()[crossing.surface],
                                          context_->facets[crossing.surface],
                                          path.segment(index),
                                          point,
                                          options.softness);
    if (weight == 0.0) {
      continue;
    }
    certain_ += weight == 1.0 ? 1 : 0;
    if (weight == 1.0 && (!options.transmission || context_->opaque[crossing.surface] ||
                          certain_ > static_cast<std::size_t>(options.max_depth))) {
      return false;
    }
    const auto kind =
        options.transmission ? InteractionKind::kTransmission : InteractionKind::kShadowing;
    interactions.push_back(interaction(kind, crossing.surface, point));
    interactions.back().weight = weight;
  }
  return true;
}

}  // namespace rayloc
