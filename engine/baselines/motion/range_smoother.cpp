#include "engine/baselines/motion/range_smoother.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/check.h"
#include "engine/base/median.h"

namespace rayloc {
namespace {

constexpr double kMadToSigma = 1.4826;  // a ratio, of a Gaussian

}  // namespace

double RangeSmoother::measurement_variance() const {
  std::vector<double> off;
  off.reserve(off_.size());
  for (const double one : off_) {
    off.push_back(std::abs(one));
  }
  const double sigma = off.empty() ? 0.0 : kMadToSigma * median(std::move(off));
  return std::max(sigma * sigma, options_.sigma_floor * options_.sigma_floor);
}

void RangeSmoother::add(double rate, double seconds, double measured) {
  const double variance = measurement_variance();
  Step step;
  if (steps_.empty()) {
    step = {measured, variance, std::max(measured, options_.least), variance};
  } else {
    const double grown = options_.rate_sigma * seconds;
    step.predicted = steps_.back().filtered + rate * seconds;
    step.predicted_variance = steps_.back().filtered_variance + grown * grown;
    const double gain = step.predicted_variance / (step.predicted_variance + variance);
    step.filtered = std::max(options_.least, step.predicted + gain * (measured - step.predicted));
    step.filtered_variance = (1.0 - gain) * step.predicted_variance;
  }
  off_.push_back(measured - step.filtered);
  steps_.push_back(step);
  if (off_.size() > options_.remembered) {
    off_.pop_front();
  }
  if (steps_.size() > options_.lag + 1) {
    steps_.pop_front();
  }
}

SmoothedRange RangeSmoother::smoothed() const {
  RAYLOC_CHECK(is_ready());
  SmoothedRange later{steps_.back().filtered, steps_.back().filtered_variance};
  for (std::size_t i = steps_.size() - 1; i > 0; --i) {
    const Step& step = steps_[i - 1];
    const Step& next = steps_[i];
    const double gain = step.filtered_variance / next.predicted_variance;
    later = {std::max(options_.least, step.filtered + gain * (later.length - next.predicted)),
             step.filtered_variance + gain * gain * (later.variance - next.predicted_variance)};
  }
  return later;
}

void RangeSmoother::clear() {
  steps_.clear();
  off_.clear();
}

}  // namespace rayloc
