// RangeSmoother: a length with inaccurate measurements and an accurate rate, filtered forward and
// smoothed backward [KS] over the last few steps.
//
// References: [KS] H. Rauch, F. Tung, C. Striebel, AIAA Journal 3 (1965) 1445.
#pragma once

#include <cstddef>
#include <deque>

namespace rayloc {

struct RangeSmootherOptions {
  double rate_sigma = 0.15;     // [m/s], of the rates
  double sigma_floor = 0.5;     // [m], of a measurement
  double least = 0.0;           // [m], lower limit of the length
  std::size_t lag = 6;          // steps that are smoothed backward
  std::size_t remembered = 30;  // steps used to estimate the measurements' variance
};

struct SmoothedRange {
  double length = 0.0;    // [m]
  double variance = 0.0;  // [m^2]
};

class RangeSmoother {
 public:
  explicit RangeSmoother(const RangeSmootherOptions& options = {}) : options_(options) {}

  // A step of `seconds` in which the length grew by rate * seconds [m/s], and its measurement.
  void add(double rate, double seconds, double measured);
  // State options.lag steps ago. REQUIRES: is_ready().
  SmoothedRange smoothed() const;
  bool is_ready() const { return steps_.size() > options_.lag; }
  void clear();

 private:
  struct Step {
    double predicted = 0.0;
    double predicted_variance = 0.0;
    double filtered = 0.0;
    double filtered_variance = 0.0;
  };
  double measurement_variance() const;

  RangeSmootherOptions options_;
  std::deque<Step> steps_;
  std::deque<double> off_;  // measurements minus filtered values [m]
};

}  // namespace rayloc
