#include "engine/posterior/access_point_fusion.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"

namespace rayloc {

namespace {

double log_sum_exp(std::span<const double> terms) {
  const double top = *std::max_element(terms.begin(), terms.end());
  double sum = 0.0;
  for (const double term : terms) {
    sum += std::exp(term - top);
  }
  return top + std::log(sum);
}

}  // namespace

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
    Terms log_means{log_mean_exp(maps[i], likelihood_exponent, weights)};
    for (std::size_t k = 0; k < kBlunted.size(); ++k) {
      log_means[1 + k] = log_mean_exp(maps[i], kBlunted[k].exponent * likelihood_exponent, weights);
    }
    add(log_means, faulty[i]);
  }
}

AccessPointFusion AccessPointFusion::of_means(std::span<const Terms> log_means,
                                              double likelihood_exponent,
                                              std::span<const double> faulty) {
  RAYLOC_CHECK(!log_means.empty() && log_means.size() == faulty.size());
  AccessPointFusion fusion(likelihood_exponent);
  for (std::size_t i = 0; i < log_means.size(); ++i) {
    fusion.add(log_means[i], faulty[i]);
  }
  return fusion;
}

void AccessPointFusion::add(const Terms& log_means, double faulty) {
  RAYLOC_CHECK(faulty > 0.0 && faulty < 1.0);
  log_mean_.push_back(log_means.front());
  log_right_.push_back(std::log1p(-faulty));
  log_wrong_.push_back(std::log(faulty) + log_mean_.back());
  log_nothing_ += log_wrong_.back();
  auto& factor = log_factor_.emplace_back();
  double whole = 1.0;
  for (std::size_t k = 0; k < kBlunted.size(); ++k) {
    const Blunted& blunted = kBlunted[k];
    whole -= blunted.probability;
    factor[1 + k] =
        std::log(blunted.probability) + log_right_.back() + log_mean_.back() - log_means[1 + k];
  }
  factor[0] = std::log(whole) + log_right_.back();
}

AccessPointFusion::Terms AccessPointFusion::right(std::size_t i, double log_likelihood) const {
  const double tempered = likelihood_exponent_ * log_likelihood;
  Terms terms = log_factor_[i];
  terms[0] += tempered;
  for (std::size_t k = 0; k < kBlunted.size(); ++k) {
    terms[1 + k] += kBlunted[k].exponent * tempered;
  }
  return terms;
}

double AccessPointFusion::log_likelihood(std::span<const double> of_each) const {
  if (log_right_.size() == 1) {  // uncontradicted: the added and the subtracted terms cancel
    return std::max(kNothing, log_right_.front() / likelihood_exponent_ + of_each.front());
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < log_right_.size(); ++i) {
    sum += log_add(log_sum_exp(right(i, of_each[i])), log_wrong_[i]);
  }
  // ln (exp(sum) - exp(nothing))
  const double above = sum - log_nothing_;
  if (!(above > 0.0)) {
    return kNothing;
  }
  return std::max(kNothing, (sum + std::log(-std::expm1(-above))) / likelihood_exponent_);
}

double AccessPointFusion::faulty(std::size_t i, double log_likelihood) const {
  const Terms terms = right(i, log_likelihood);
  const double log_valid = log_sum_exp(std::span(terms).first(kBlunted.size()));
  return 1.0 / (1.0 + std::exp(log_valid - log_add(terms.back(), log_wrong_[i])));
}

double AccessPointFusion::outlier(double log_mean, double prior) const {
  // For a device outside the area each access point fits about as well as in the mean.
  double log_outside = 0.0;
  for (const double one : log_mean_) {
    log_outside += one;
  }
  const double nothing = log_add(std::log(prior) + log_outside, std::log1p(-prior) + log_nothing_);
  return 1.0 / (1.0 + std::exp(std::log1p(-prior) + log_mean - nothing));
}

}  // namespace rayloc
