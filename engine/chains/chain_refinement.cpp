#include "engine/chains/chain_refinement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "engine/base/check.h"
#include "engine/observe/chain_gains.h"
#include "engine/posterior/access_point_fusion.h"

namespace rayloc {
namespace {

using Value = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kIterations = 8;    // a count, chosen: bounds the time
constexpr double kStep = 0.02;    // [rad] and in ln: distance of the points of a difference
constexpr double kMaxStep = 0.3;  // [rad] and in ln, per iteration: places would change
constexpr double kSmall = 1e-3;   // [rad], step of the last iteration

// Unknowns: the phases of all chains but the first, then ln |factor| of all.
class Objective {
 public:
  Objective(std::span<const PlacedBurst> bursts,
            const std::vector<Value>& start,
            double likelihood_exponent)
      : bursts_(bursts), start_(start), likelihood_exponent_(likelihood_exponent) {}

  Index chains() const { return static_cast<Index>(start_.size()); }
  Index unknowns() const { return 2 * chains() - 1; }

  double operator()(const VectorXd& at) const {
    const auto z = undoing(at);
    double sum = 0.0;
    for (const PlacedBurst& burst : bursts_) {
      sum += burst.places.empty() ? burst.floor : log_add(log_sum(burst, z), burst.floor);
    }
    for (Index m = 0; m < chains(); ++m) {
      const double log_gain = at(chains() - 1 + m) / kChainGainSigma;
      sum -= 0.5 * log_gain * log_gain;
    }
    return sum;
  }

  std::vector<Value> undoing(const VectorXd& at) const {
    std::vector<Value> z;
    for (Index m = 0; m < chains(); ++m) {
      z.push_back(1.0 / factor(at, m));
    }
    return z;
  }

  Value factor(const VectorXd& at, Index m) const {
    return start_[static_cast<std::size_t>(m)] *
           std::polar(std::exp(at(chains() - 1 + m)), m == 0 ? 0.0 : at(m - 1));
  }

 private:
  double log_sum(const PlacedBurst& burst, const std::vector<Value>& z) const {
    std::vector<double> terms;
    terms.reserve(burst.places.size());
    for (std::size_t i = 0; i < burst.places.size(); ++i) {
      terms.push_back(likelihood_exponent_ * burst.places[i].log_likelihood(z) +
                      burst.log_weight[i]);
    }
    const double top = *std::max_element(terms.begin(), terms.end());
    double sum = 0.0;
    for (const double term : terms) {
      sum += std::exp(term - top);
    }
    return top + std::log(sum);
  }

  std::span<const PlacedBurst> bursts_;
  const std::vector<Value>& start_;
  double likelihood_exponent_;
};

struct Shape {
  VectorXd slope;
  MatrixXd information;  // from the curvature; positive definite
};

Shape shape_at(const Objective& f, const VectorXd& at) {
  const Index n = at.size();
  Shape shape{VectorXd(n), MatrixXd(n, n)};
  const double middle = f(at);
  const auto moved = [&](Index i, double by_i, Index j, double by_j) {
    VectorXd x = at;
    x(i) += by_i;
    x(j) += by_j;
    return f(x);
  };
  for (Index i = 0; i < n; ++i) {
    const double ahead = moved(i, kStep, i, 0.0);
    const double behind = moved(i, -kStep, i, 0.0);
    shape.slope(i) = (ahead - behind) / (2.0 * kStep);
    shape.information(i, i) = (2.0 * middle - ahead - behind) / (kStep * kStep);
    for (Index j = 0; j < i; ++j) {
      shape.information(i, j) = (moved(i, kStep, j, -kStep) + moved(i, -kStep, j, kStep) -
                                 moved(i, kStep, j, kStep) - moved(i, -kStep, j, -kStep)) /
                                (4.0 * kStep * kStep);
      shape.information(j, i) = shape.information(i, j);
    }
  }
  // Between two maxima the curvature has the other sign; lower bound: that of sigma = 1 rad.
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(shape.information);
  const VectorXd values = axes.eigenvalues().cwiseMax(1.0);
  shape.information = axes.eigenvectors() * values.asDiagonal() * axes.eigenvectors().transpose();
  return shape;
}

}  // namespace

ChainFactors ChainFactors::unity(std::size_t chains) {
  return {
      std::vector<Value>(chains, 1.0), std::vector<double>(chains), std::vector<double>(chains)};
}

ChainFactors refine_chains(std::span<const PlacedBurst> bursts,
                           const std::vector<Value>& start,
                           double likelihood_exponent) {
  RAYLOC_CHECK(!bursts.empty() && !start.empty());
  const Objective f(bursts, start, likelihood_exponent);
  VectorXd at = VectorXd::Zero(f.unknowns());
  double value = f(at);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Shape shape = shape_at(f, at);
    VectorXd step = shape.information.llt().solve(shape.slope);
    const double longest = step.cwiseAbs().maxCoeff();
    step *= std::min(1.0, kMaxStep / std::max(longest, kSmall));
    double next = f(at + step);
    while (next < value && step.cwiseAbs().maxCoeff() > kSmall) {
      step *= 0.5;
      next = f(at + step);
    }
    if (next < value) {
      break;
    }
    at += step;
    value = next;
    if (step.cwiseAbs().maxCoeff() < kSmall) {
      break;
    }
  }
  const MatrixXd covariance = shape_at(f, at).information.inverse();
  ChainFactors result;
  // The volume of the refined maximum counts, not its height alone.
  result.log_evidence = value + 0.5 * std::log(covariance.determinant());
  double log_gain = 0.0;
  for (Index m = 0; m < f.chains(); ++m) {
    result.factor.push_back(f.factor(at, m));
    log_gain += std::log(std::abs(result.factor.back())) / static_cast<double>(f.chains());
    result.sigma.push_back(m == 0 ? 0.0 : std::sqrt(covariance(m - 1, m - 1)));
    const Index l = f.chains() - 1 + m;
    result.log_gain_sigma.push_back(std::sqrt(covariance(l, l)));
  }
  const Value common = std::polar(std::exp(-log_gain), -std::arg(result.factor[0]));
  for (Value& factor : result.factor) {
    factor *= common;
  }
  return result;
}

}  // namespace rayloc
