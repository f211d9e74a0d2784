// PathLink: which of the paths of each window are one target's [W2].
//
// The paper's binary programme over a few windows is, with one target, a shortest path: nodes cost
// -ln of their share of the energy, edges what rate, delay and phase differ by. It is found
// exactly, window by window, and told some windows later.
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

  // The target's path `windows` ago, where that was heard. REQUIRES: paths not empty.
  std::optional<MotionPath> add(std::vector<MotionPath> paths);
  void clear() { heard_.clear(); }

 private:
  struct Window {
    std::vector<MotionPath> paths;
    std::vector<double> cost;         // of the best way to each
    std::vector<std::size_t> before;  // on that way
  };

  std::size_t windows_;
  std::deque<Window> heard_;
};

}  // namespace rayloc
