// PairedComparison: compares two hypotheses on a survey by how well they explain the same points.
//
// Correlations of the same point are compared in pairs: a room that is modelled badly is modelled
// badly under both hypotheses.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

namespace rayloc {

// How well each point is explained; nullopt where it was not received or is not reached.
using Correlations = std::vector<std::optional<double>>;

// Pairs of a point and an access point from which on their spread counts as well estimated.
constexpr std::size_t kMinPairs = 12;
// With fewer pairs than this no result is given. A ratio, chosen: half as many.
constexpr std::size_t kFewestPairs = kMinPairs / 2;
// Quantiles of Student's t: the number of standard errors as rare as 3 of a normal distribution
// (0.99865), for kFewestPairs pairs and each one more (JCGM 100:2008, table G.2).
constexpr std::array<double, kMinPairs - kFewestPairs> kThreeOfFew = {
    5.51, 4.90, 4.53, 4.28, 4.09, 3.96};

class PairedComparison {
 public:
  void add(const Correlations& stated, const Correlations& other) {
    for (std::size_t i = 0; i < stated.size(); ++i) {
      if (stated[i] && other[i]) {
        difference_.push_back(*other[i] - *stated[i]);
        stated_ += *stated[i];
        other_ += *other[i];
      }
    }
  }

  std::size_t pairs() const { return difference_.size(); }
  bool empty() const { return difference_.empty(); }
  // Mean correlations. REQUIRES: not empty.
  double stated() const { return stated_ / static_cast<double>(difference_.size()); }
  double other() const { return other_ / static_cast<double>(difference_.size()); }
  double gained() const { return other_ - stated_; }  // summed over the pairs

  // Mean difference over its standard error; 0 with too few pairs or no error. With fewer than
  // kMinPairs pairs it is reduced, so that 3 is as rare as with many.
  double significance() const {
    const auto count = static_cast<double>(difference_.size());
    if (difference_.size() < kFewestPairs) {
      return 0.0;
    }
    const double mean = gained() / count;
    double square = 0.0;
    for (const double d : difference_) {
      square += (d - mean) * (d - mean);
    }
    const double error = std::sqrt(square / (count * (count - 1.0)));
    const double known = difference_.size() < kMinPairs
                             ? 3.0 / kThreeOfFew.at(difference_.size() - kFewestPairs)
                             : 1.0;
    return error > 0.0 ? known * mean / error : 0.0;
  }

 private:
  std::vector<double> difference_;
  double stated_ = 0.0;
  double other_ = 0.0;
};

}  // namespace rayloc
