#include "engine/trace/mirror_grower.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/trace/beam_shadow.h"
#include "engine/trace/image_method.h"
#include "engine/trace/mirror_trie.h"

namespace rayloc {
namespace {

// Closer to a mirror's plane than this, a point is on it and has no reflection there [m].
constexpr double kOnPlane = 1e-9;
// So far inside the edges of what stands in the way, and so far from both ends, no rounding and no
// tolerance changes a verdict [m].
constexpr double kCertain = 1e-6;
// Of the mirrors that a beam lights, so many are tried as things in the way of the others.
constexpr std::size_t kMaxOccluders = 12;
constexpr std::size_t kFew = 16;
// Of an object with more surfaces than this only those that rays met are proposed.
constexpr std::uint32_t kMostNeighbours = 32;

// About the solid angle that a polygon fills, seen from `apex_distance` away from its plane.
double apparent_size(std::span<const Vec3d> polygon, const Vec3d& apex, double apex_distance) {
  Vec3d twice_area;
  Vec3d sum;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d& next = polygon[i + 1 == polygon.size() ? 0 : i + 1];
    twice_area = twice_area + cross(polygon[i] - polygon[0], next - polygon[0]);
    sum = sum + polygon[i];
  }
  const double away = norm((1.0 / static_cast<double>(polygon.size())) * sum - apex);
  return 0.5 * norm(twice_area) * std::abs(apex_distance) / (away * away * away);
}

template <typename T, typename Range>
void append_to(std::vector<T>& to, const Range& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

void LitWindows::append(const LitWindows& other) {
  const std::size_t shift = corners.size();
  append_to(crossings, other.crossings);
  append_to(corners, other.corners);
  append_to(trie_nodes, other.trie_nodes);
  for (const std::size_t end : other.ends) {
    ends.push_back(shift + end);
  }
}

void MirrorGrower::grow(const Parent& parent, const Vec3d& root, GrownNodes& grown) {
  const bool is_root = parent.node == kRootNode;
  Plane<double> front;
  bounds_.clear();
  if (!is_root) {
    front = facing_away(table_.plane(parent.surface), parent.image);
    beam_planes(parent.image, parent.image_distance, parent.window, bounds_);
    bounds_.push_back(front);
  }
  find_lit(parent);
  occluders_.clear();
  // A few images too many at the last level cost less than to see that they are.
  if (parent.depth + 1 < options_.max_depth || lit_.size() > kFew) {
    choose_occluders();
  }
  const BeamShadow shadow(parent.image, is_root ? nullptr : &front, options_.softness + kCertain);
  // Interactions that are left for crossings.
  const int allowed = options_.transmission ? options_.max_depth - parent.depth - 1 : 0;
  for (const Lit& lit : lit_) {
    const auto window = std::span(corners_).subspan(lit.first, lit.count);
    int crossings = parent.crossings;
    for (auto i = occluders_.begin(); i != occluders_.end() && crossings <= allowed; ++i) {
      // What hides a window fills more of the view; the sizes are estimates.
      const bool may_hide = 2.0 * i->size > lit.size && i->surface != lit.surface;
      crossings += may_hide && shadow.hides(*i->shape, window) ? 1 : 0;
    }
    if (crossings <= allowed) {
      add(parent, lit, root, grown);
      if (parent.depth + 1 < options_.max_depth) {
        grown.windows.crossings.push_back(static_cast<std::uint8_t>(crossings));
        append_to(grown.windows.corners, window);
        grown.windows.ends.push_back(grown.windows.corners.size());
        if (trie_ != nullptr) {
          grown.windows.trie_nodes.push_back(trie_child(parent.trie_node, lit.surface));
        }
      }
    }
  }
}

void MirrorGrower::find_lit(const Parent& parent) {
  lit_.clear();
  corners_.clear();
  if (trie_ == nullptr) {
    table_.find(bounds_, found_);
  } else {
    find_proposed(parent.trie_node);
  }
  for (const std::uint32_t surface : found_) {
    const double here = distance(table_.plane(surface), parent.image);
    if (surface == parent.surface || std::abs(here) < kOnPlane || !table_.is_lit(surface, here) ||
        !light(surface, here, parent.window)) {
      continue;
    }
    lit_.push_back({surface,
                    here,
                    corners_.size(),
                    polygon_.size(),
                    apparent_size(polygon_, parent.image, here)});
    append_to(corners_, polygon_);
  }
}

void MirrorGrower::find_proposed(std::uint32_t trie_node) {
  found_.clear();
  if (trie_node == kNoTrieNode) {
    return;
  }
  for (const std::uint32_t surface : trie_->children(trie_node).surfaces) {
    const auto [first, end] = scene_.surfaces_of(scene_.owner(surface).object);
    if (end - first > kMostNeighbours) {
      found_.push_back(surface);
      continue;
    }
    for (std::uint32_t i = first; i < end; ++i) {
      found_.push_back(i);
    }
  }
  std::sort(found_.begin(), found_.end());
  found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
}

std::uint32_t MirrorGrower::trie_child(std::uint32_t trie_node, std::uint32_t surface) const {
  const auto [first, surfaces] = trie_->children(trie_node);
  const auto found = std::lower_bound(surfaces.begin(), surfaces.end(), surface);
  return found == surfaces.end() || *found != surface
             ? kNoTrieNode
             : first + static_cast<std::uint32_t>(found - surfaces.begin());
}

// Whether the beam reaches the surface from the side where its apex is; polygon_ is then the part
// that it lights.
bool MirrorGrower::light(std::uint32_t surface,
                         double apex_distance,
                         std::span<const Vec3d> window) {
  const Plane<double>& plane = table_.plane(surface);
  const Plane<double> front =
      apex_distance > 0.0 ? plane : Plane<double>{-plane.normal, -plane.offset};
  if (!window.empty() && is_outside(front, window)) {
    return false;
  }
  polygon_ = table_.outline(surface);
  for (const Plane<double>& bound : bounds_) {
    clip(bound, polygon_, scratch_);
    if (polygon_.size() < 3) {
      return false;
    }
  }
  return true;
}

// The largest, as the apex sees them.
void MirrorGrower::choose_occluders() {
  order_.resize(lit_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  const auto end =
      order_.begin() + static_cast<std::ptrdiff_t>(std::min(lit_.size(), kMaxOccluders));
  std::partial_sort(order_.begin(), end, order_.end(), [&](std::size_t a, std::size_t b) {
    return lit_[a].size > lit_[b].size;
  });
  for (auto i = order_.begin(); i != end; ++i) {
    const Lit& lit = lit_[*i];
    occluders_.push_back({lit.surface, &scene_.surfaces()[lit.surface], lit.size});
  }
}

void MirrorGrower::add(const Parent& parent, const Lit& lit, const Vec3d& root, GrownNodes& grown) {
  const auto window = std::span(corners_).subspan(lit.first, lit.count);
  const Vec3d image = mirror(table_.plane(lit.surface), parent.image);
  grown.nodes.push_back({image, -lit.apex_distance, lit.surface, parent.node});
  beam_planes(image, -lit.apex_distance, window, planes_);
  // First of all the front, which is always needed.
  planes_.insert(planes_.begin(), facing_away(table_.plane(lit.surface), image));
  grown.beams.emplace_back(planes_, root);
}

}  // namespace rayloc
