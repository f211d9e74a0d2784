#include "engine/trace/images/mirror_grower.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "engine/trace/image_method.h"
#include "engine/trace/images/beam_shadow.h"
#include "engine/trace/images/mirror_trie.h"
#include "engine/trace/images/tolerances.h"

namespace rayloc {
namespace {

// At this distance inside the edges of an obstruction, and from both ends, no rounding and no
// tolerance changes the result [m].
constexpr double kCertainOcclusion = 1e-6;
// Maximum number of lit mirrors that are tested as obstructions of the others.
constexpr std::size_t kMaxOccluders = 12;
// A count, chosen: with so few lit mirrors images of the last level get no shadow test.
constexpr std::size_t kFewLit = 16;
// For an object with more surfaces than this only those that rays met are proposed.
constexpr std::uint32_t kMaxNeighbours = 32;

// About the solid angle of a polygon, seen from `apex_distance` away from its plane.
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

template <typename Visit>
void for_each_root(RootSet roots, const Visit& visit) {
  for (; roots != 0; roots &= roots - 1) {
    visit(static_cast<std::size_t>(std::countr_zero(roots)));
  }
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

void MirrorGrower::grow(const Parent& parent, GrownNodes& grown) {
  apexes_.clear();
  for_each_root(parent.roots,
                [&](std::size_t root) { apexes_.push_back(parent.images[root].point); });
  const bool is_root = parent.node == kRootNode;
  Plane<double> front;
  bounds_.clear();
  if (!is_root) {
    front = facing_away(table_.plane(parent.surface), apexes_.front());
    const double side = distance(table_.plane(parent.surface), apexes_.front());
    beam_planes(apexes_, side, parent.window, bounds_);
    bounds_.push_back(front);
  }
  find_lit(parent);
  occluders_.clear();
  // A few superfluous images at the last level cost less than the test that finds them.
  if (parent.depth + 1 < options_.max_depth || lit_.size() > kFewLit) {
    choose_occluders();
  }
  // Interactions left for crossings.
  const int allowed = options_.transmission ? options_.max_depth - parent.depth - 1 : 0;
  for (const Lit& lit : lit_) {
    const int met = parent.crossings +
                    crossings(parent, is_root ? nullptr : &front, lit, allowed - parent.crossings);
    if (met <= allowed) {
      add(parent, lit, met, grown);
    }
  }
}

int MirrorGrower::crossings(const Parent& parent,
                            const Plane<double>* start,
                            const Lit& lit,
                            int limit) const {
  const auto window = std::span(corners_).subspan(lit.first, lit.count);
  int count = 0;
  for (auto i = occluders_.begin(); i != occluders_.end() && count <= limit; ++i) {
    // A surface that hides a window fills more of the view; the sizes are estimates.
    if (2.0 * i->size <= lit.size || i->surface == lit.surface) {
      continue;
    }
    bool hides = true;
    for_each_root(lit.roots, [&](std::size_t root) {
      hides = hides &&
              BeamShadow(parent.images[root].point, start, options_.softness + kCertainOcclusion)
                  .hides(*i->shape, window);
    });
    count += hides ? 1 : 0;
  }
  return count;
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
    if (surface == parent.surface) {
      continue;
    }
    std::array<RootSet, 2> lit_by{};  // from behind, from the front
    for_each_root(parent.roots, [&](std::size_t root) {
      const double here = distance(table_.plane(surface), parent.images[root].point);
      if (std::abs(here) >= kMinPlaneDistance && table_.is_lit(surface, root, here)) {
        lit_by[here > 0.0 ? 1 : 0] |= RootSet{1} << root;
      }
    });
    for (const double side : {-1.0, 1.0}) {
      const RootSet roots = lit_by[side > 0.0 ? 1 : 0];
      if (roots == 0 || !light(surface, side, parent.window)) {
        continue;
      }
      const Vec3d& apex = parent.images[static_cast<std::size_t>(std::countr_zero(roots))].point;
      lit_.push_back({surface,
                      roots,
                      side,
                      corners_.size(),
                      polygon_.size(),
                      apparent_size(polygon_, apex, distance(table_.plane(surface), apex))});
      append_to(corners_, polygon_);
    }
  }
}

void MirrorGrower::find_proposed(std::uint32_t trie_node) {
  found_.clear();
  if (trie_node == kNoTrieNode) {
    return;
  }
  for (const std::uint32_t surface : trie_->children(trie_node).surfaces) {
    const auto [first, end] = scene_.surfaces_of(scene_.owner(surface).object);
    if (end - first > kMaxNeighbours) {
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

// True if the beam reaches the surface from that side; polygon_ is then the part that it lights.
bool MirrorGrower::light(std::uint32_t surface, double side, std::span<const Vec3d> window) {
  const Plane<double>& plane = table_.plane(surface);
  const Plane<double> front = side > 0.0 ? plane : Plane<double>{-plane.normal, -plane.offset};
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

// Chooses the largest, as the apex sees them.
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
    // Lit from both sides by different roots, a surface still is one obstruction.
    const bool is_known =
        std::any_of(occluders_.begin(), occluders_.end(), [&](const Occluder& occluder) {
          return occluder.surface == lit.surface;
        });
    if (is_known) {
      continue;
    }
    occluders_.push_back({lit.surface, &scene_.surfaces()[lit.surface], lit.size});
  }
}

void MirrorGrower::add(const Parent& parent, const Lit& lit, int crossings, GrownNodes& grown) {
  const auto window = std::span(corners_).subspan(lit.first, lit.count);
  const Plane<double>& plane = table_.plane(lit.surface);
  grown.nodes.push_back({lit.surface, parent.node, lit.roots});
  const std::size_t first = grown.images.size();
  grown.images.resize(first + parent.images.size());
  apexes_.clear();
  for_each_root(lit.roots, [&](std::size_t root) {
    const Vec3d& image = parent.images[root].point;
    grown.images[first + root] = {mirror(plane, image), -distance(plane, image)};
    apexes_.push_back(grown.images[first + root].point);
  });
  beam_planes(apexes_, -lit.side, window, planes_);
  // The front is inserted first, since it is always needed.
  planes_.insert(planes_.begin(), facing_away(plane, apexes_.front()));
  grown.beams.emplace_back(planes_, table_.reference());
  if (parent.depth + 1 < options_.max_depth) {
    grown.windows.crossings.push_back(static_cast<std::uint8_t>(crossings));
    append_to(grown.windows.corners, window);
    grown.windows.ends.push_back(grown.windows.corners.size());
    if (trie_ != nullptr) {
      grown.windows.trie_nodes.push_back(trie_child(parent.trie_node, lit.surface));
    }
  }
}

}  // namespace rayloc
