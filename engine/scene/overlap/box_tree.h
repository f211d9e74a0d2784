// BoxTree: finds the boxes in a plane that meet another, without comparing all pairs.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/scene/orientation.h"

namespace rayloc {

struct Box2 {
  Point2 lower, upper;
};

class BoxTree {
 public:
  explicit BoxTree(std::vector<Box2> boxes);

  // The numbers of the boxes that have a point in common with `box`, ascending.
  std::vector<std::size_t> meeting(const Box2& box) const;

 private:
  struct Node {
    Box2 box;               // around all descendants
    std::size_t first = 0;  // of order_
    std::size_t end = 0;
    std::size_t children = 0;  // the first of two; 0: a leaf
  };
  void split(std::size_t node);

  std::vector<Box2> boxes_;
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;  // the root is the first
};

}  // namespace rayloc
