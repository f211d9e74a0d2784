#include "engine/posterior/access_point_fusion.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"

namespace rayloc {

double log_add(double a, double b) {
  const double top = std::max(a, b);
  return top + std::log1p(std::exp(std::min(a, b) - top));
}

double log_mean_exp(std::span<const double> log_likelihood,
                    double likelihood_exponent,
                    const CellWeights& weights) {
  const double top = *std::max_element(log_likelihood.begin(), log_likelihood.end());
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t n = 0; n < log_likelihood.size(); ++n) {
    const double weight = weights.of(n);
    sum += weight * std::exp(likelihood_exponent * (log_likelihood[n] - top));
    count += weight;
  }
  return likelihood_exponent * top + std::log(sum / count);
}

AccessPointFusion::AccessPointFusion(std::span<const std::vector<double>> maps,
                                     double likelihood_exponent,
                                     std::span<const double> faulty,
                                     const CellWeights& weights)
    : likelihood_exponent_(likelihood_exponent) {
  RAYLOC_CHECK(!maps.empty() && maps.size() == faulty.size());
  for (std::size_t i = 0; i < maps.size(); ++i) {
    RAYLOC_CHECK(faulty[i] > 0.0 && faulty[i] < 1.0);
    log_mean_.push_back(log_mean_exp(maps[i], likelihood_exponent, weights));
    log_right_.push_back(std::log1p(-faulty[i]));
    log_wrong_.push_back(std::log(faulty[i]) + log_mean_.back());
    log_nothing_ += log_wrong_.back();
  }
}

double AccessPointFusion::log_likelihood(std::span<const double> of_each) const {
  if (log_right_.size() == 1) {  // nobody contradicts it: what it adds and takes is the same
    return std::max(kNothing, log_right_.front() / likelihood_exponent_ + of_each.front());
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < log_right_.size(); ++i) {
    sum += log_add(log_right_[i] + likelihood_exponent_ * of_each[i], log_wrong_[i]);
  }
  // ln (exp(sum) - exp(nothing))
  const double above = sum - log_nothing_;
  if (!(above > 0.0)) {
    return kNothing;
  }
  return std::max(kNothing, (sum + std::log(-std::expm1(-above))) / likelihood_exponent_);
}

double AccessPointFusion::faulty(std::size_t i, double log_likelihood) const {
  const double odds = log_right_[i] + likelihood_exponent_ * log_likelihood - log_wrong_[i];
  return 1.0 / (1.0 + std::exp(odds));
}

double AccessPointFusion::elsewhere(double log_mean, double prior) const {
  // Each access point, of a device elsewhere, fits about as well as it does in the mean.
  double log_outside = 0.0;
  for (const double one : log_mean_) {
    log_outside += one;
  }
  const double nothing = log_add(std::log(prior) + log_outside, std::log1p(-prior) + log_nothing_);
  return 1.0 / (1.0 + std::exp(std::log1p(-prior) + log_mean - nothing));
}

}  // namespace rayloc
