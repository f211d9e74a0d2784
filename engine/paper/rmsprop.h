// Rmsprop: descent by gradients divided by their own running size, with momentum; the optimiser
// that the paper names for localization (METHODS A4) and also uses for its calibration.
//
//   s <- decay s + (1 - decay) g^2,   v <- momentum v + g / (sqrt(s / (1 - decay^t)) + least),
//   x <- x - rate v.
//
// Gradients are with respect to x in units of its rate, so `least` is a change of the loss by one
// such step: parameters with little effect hardly move.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/check.h"

namespace rayloc::paper {

struct RmspropOptions {
  double decay = 0.9;     // of the running mean square, [0, 1)
  double momentum = 0.6;  // [0, 1)
  double least = 1e-6;    // > 0
};

class Rmsprop {
 public:
  // `rate`: step length of each number, in its unit.
  Rmsprop(std::vector<double> rate, const RmspropOptions& options)
      : options_(options), rate_(std::move(rate)), square_(rate_.size()), velocity_(rate_.size()) {}

  // One step of x. REQUIRES: sizes equal to that of the rates.
  void step(std::span<const double> gradient, std::span<double> x) {
    RAYLOC_CHECK(gradient.size() == rate_.size() && x.size() == rate_.size());
    remembered_ *= options_.decay;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double g = rate_[i] * gradient[i];
      square_[i] = options_.decay * square_[i] + (1.0 - options_.decay) * g * g;
      const double size = std::sqrt(square_[i] / (1.0 - remembered_));
      velocity_[i] = options_.momentum * velocity_[i] + g / (size + options_.least);
      x[i] -= rate_[i] * velocity_[i];
    }
  }

 private:
  RmspropOptions options_;
  std::vector<double> rate_;
  std::vector<double> square_;
  std::vector<double> velocity_;
  double remembered_ = 1.0;  // decay^t
};

}  // namespace rayloc::paper
