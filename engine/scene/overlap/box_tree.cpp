#include "engine/scene/overlap/box_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace rayloc {
namespace {

// A count, chosen: comparing so many boxes takes as long as visiting two nodes.
constexpr std::size_t kLeafBoxes = 4;

bool have_common_point(const Box2& a, const Box2& b) {
  return a.lower.u <= b.upper.u && b.lower.u <= a.upper.u && a.lower.v <= b.upper.v &&
         b.lower.v <= a.upper.v;
}

}  // namespace

BoxTree::BoxTree(std::vector<Box2> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  if (boxes_.empty()) {
    return;
  }
  nodes_.push_back({{}, 0, order_.size()});
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    split(node);
  }
}

void BoxTree::split(std::size_t node) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Box2 all{{kInfinity, kInfinity}, {-kInfinity, -kInfinity}};
  const std::size_t first = nodes_[node].first;
  const std::size_t end = nodes_[node].end;
  for (std::size_t i = first; i < end; ++i) {
    const Box2& box = boxes_[order_[i]];
    all.lower = {std::min(all.lower.u, box.lower.u), std::min(all.lower.v, box.lower.v)};
    all.upper = {std::max(all.upper.u, box.upper.u), std::max(all.upper.v, box.upper.v)};
  }
  nodes_[node].box = all;
  if (end - first <= kLeafBoxes) {
    return;
  }
  const bool along_u = all.upper.u - all.lower.u > all.upper.v - all.lower.v;
  const auto twice_middle = [&](std::size_t i) {
    const Box2& box = boxes_[i];
    return along_u ? box.lower.u + box.upper.u : box.lower.v + box.upper.v;
  };
  const std::size_t middle = first + (end - first) / 2;
  std::nth_element(order_.begin() + static_cast<std::ptrdiff_t>(first),
                   order_.begin() + static_cast<std::ptrdiff_t>(middle),
                   order_.begin() + static_cast<std::ptrdiff_t>(end),
                   [&](std::size_t i, std::size_t j) { return twice_middle(i) < twice_middle(j); });
  nodes_[node].children = nodes_.size();
  nodes_.push_back({{}, first, middle});
  nodes_.push_back({{}, middle, end});
}

std::vector<std::size_t> BoxTree::meeting(const Box2& box) const {
  std::vector<std::size_t> found;
  std::vector<std::size_t> open;
  if (!nodes_.empty()) {
    open.push_back(0);
  }
  while (!open.empty()) {
    const Node& node = nodes_[open.back()];
    open.pop_back();
    if (!have_common_point(node.box, box)) {
      continue;
    }
    if (node.children > 0) {
      open.push_back(node.children);
      open.push_back(node.children + 1);
      continue;
    }
    for (std::size_t i = node.first; i < node.end; ++i) {
      if (have_common_point(boxes_[order_[i]], box)) {
        found.push_back(order_[i]);
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace rayloc
