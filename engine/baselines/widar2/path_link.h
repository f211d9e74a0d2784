// PathLink: selects the path of one target in each window [W2].
//
// For one target, the paper's binary programme over a few windows is a shortest path: the cost of a
// node is -ln of its share of the energy, that of an edge the difference of rate, delay and phase.
// The solution is exact, window by window, and returned some windows later.
//
// References: [W2] as in engine/baselines/motion/conjugate_product.h.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "engine/baselines/motion/motion_sage.h"

namespace rayloc {

class PathLink {
 public:
  explicit PathLink(std::size_t windows) : windows_(windows) {}

  // The target's path `windows` ago, if it was received. REQUIRES: paths not empty.
  std::optional<MotionPath> add(std::vector<MotionPath> paths);
  void clear() { received_.clear(); }

 private:
  struct Window {
    std::vector<MotionPath> paths;
    std::vector<double> cost;         // of the best sequence to each path
    std::vector<std::size_t> before;  // predecessor in that sequence
  };

  std::size_t windows_;
  std::deque<Window> received_;
};

}  // namespace rayloc
