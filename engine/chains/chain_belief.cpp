#include "engine/chains/chain_belief.h"

#include <algorithm>
#include <cmath>

#include "engine/base/check.h"

namespace rayloc {
namespace {

constexpr double kChange = 1e-4;  // a probability, chosen: that chains change before the next burst
constexpr double kNear = 0.6;     // [rad], chosen: states nearer than this are one, known roughly

}  // namespace

ChainBelief::ChainBelief(std::size_t chains, double rotated)
    : grid_(chains), probability_(grid_.size()) {
  probability_[0] = 1.0;
  suspect(rotated);
}

void ChainBelief::suspect(double probability) {
  for (double& value : probability_) {
    value = (1.0 - probability) * value + probability / static_cast<double>(probability_.size());
  }
}

std::vector<double> ChainBelief::suspect_for_now(double probability) {
  std::vector<double> undoing = probability_;
  suspect(probability);
  for (std::size_t s = 0; s < undoing.size(); ++s) {
    undoing[s] /= probability_[s];
  }
  return undoing;
}

void ChainBelief::multiply(std::span<const double> factor) {
  RAYLOC_CHECK(factor.size() == probability_.size());
  double sum = 0.0;
  for (std::size_t s = 0; s < probability_.size(); ++s) {
    probability_[s] *= factor[s];
    sum += probability_[s];
  }
  for (double& value : probability_) {
    value /= sum;
  }
}

void ChainBelief::settle() {
  std::fill(probability_.begin(), probability_.end(), 0.0);
  probability_[0] = 1.0;
  suspect(kChange);
}

void ChainBelief::resume(std::span<const double> probability) {
  RAYLOC_CHECK(probability.size() == probability_.size());
  probability_.assign(probability.begin(), probability.end());
}

void ChainBelief::receive(std::span<const double> log_evidence) {
  RAYLOC_CHECK(log_evidence.size() == probability_.size());
  const double best = *std::max_element(log_evidence.begin(), log_evidence.end());
  double sum = 0.0;
  for (std::size_t s = 0; s < probability_.size(); ++s) {
    probability_[s] *= std::exp(log_evidence[s] - best) + std::exp(-kMaxOfBurst);
    sum += probability_[s];
  }
  for (double& value : probability_) {
    value /= sum;
  }
  suspect(kChange);
}

double ChainBelief::near(std::size_t state) const {
  double sum = 0.0;
  for (std::size_t s = 0; s < probability_.size(); ++s) {
    sum += is_near(s, state) ? probability_[s] : 0.0;
  }
  return sum;
}

bool ChainBelief::is_near(std::size_t a, std::size_t b) const {
  return static_cast<double>(grid_.distance(a, b)) * grid_.step() < kNear;
}

std::vector<std::size_t> ChainBelief::modes(std::size_t most) const {
  std::vector<double> left = probability_;
  std::vector<std::size_t> result;
  while (result.size() < most) {
    const auto top = std::max_element(left.begin(), left.end());
    if (*top <= 0.0) {
      break;
    }
    result.push_back(static_cast<std::size_t>(top - left.begin()));
    for (std::size_t s = 0; s < left.size(); ++s) {
      left[s] = is_near(s, result.back()) ? 0.0 : left[s];
    }
  }
  return result;
}

}  // namespace rayloc
