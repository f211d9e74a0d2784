#include "engine/chains/cell_belief.h"

#include <cmath>

#include "engine/base/check.h"
#include "engine/posterior/access_point_fusion.h"

namespace rayloc {
namespace {

double log_sum_exp(std::span<const double> terms) {
  return log_mean_exp(terms, 1.0) + std::log(static_cast<double>(terms.size()));
}

}  // namespace

void CellBelief::receive(std::span<const double> log_likelihood, double wrong) {
  RAYLOC_CHECK(log_likelihood.size() == log_weight_.size());
  const double total = log_sum_exp(log_likelihood);
  const double uniform = 1.0 / static_cast<double>(log_weight_.size());
  for (std::size_t cell = 0; cell < log_weight_.size(); ++cell) {
    log_weight_[cell] +=
        std::log((1.0 - wrong) * std::exp(log_likelihood[cell] - total) + wrong * uniform);
  }
}

std::vector<double> CellBelief::log_probability() const {
  const double total = log_sum_exp(log_weight_);
  std::vector<double> result;
  result.reserve(log_weight_.size());
  for (const double one : log_weight_) {
    result.push_back(one - total);
  }
  return result;
}

}  // namespace rayloc
