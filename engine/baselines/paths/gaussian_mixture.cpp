#include "engine/baselines/paths/gaussian_mixture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace rayloc {
namespace {

constexpr double kMinComponentShare =
    1e-9;  // of the points, a ratio: a smaller component is removed

// Well separated: each point is drawn in proportion to its squared distance from those before.
Eigen::MatrixXd starts(const Eigen::MatrixXd& points, const MixtureOptions& options) {
  std::mt19937_64 random(options.seed);
  // A uniform number in [0, 1) that is the same with every standard library.
  const auto draw = [&random] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  const Eigen::Index count = points.cols();
  const auto wanted = static_cast<Eigen::Index>(options.components);
  Eigen::MatrixXd centres(points.rows(), std::min(count, wanted));
  centres.col(0) = points.col(static_cast<Eigen::Index>(draw() * static_cast<double>(count)));
  Eigen::VectorXd squared =
      Eigen::VectorXd::Constant(count, std::numeric_limits<double>::infinity());
  for (Eigen::Index c = 1; c < centres.cols(); ++c) {
    for (Eigen::Index i = 0; i < count; ++i) {
      squared(i) = std::min(squared(i), (points.col(i) - centres.col(c - 1)).squaredNorm());
    }
    double left = draw() * squared.sum();
    Eigen::Index chosen = 0;
    while (chosen + 1 < count && left >= squared(chosen)) {
      left -= squared(chosen);
      ++chosen;
    }
    centres.col(c) = points.col(chosen);
  }
  return centres;
}

double log_density(const MixtureComponent& component, const Eigen::VectorXd& point) {
  const Eigen::ArrayXd away = (point - component.mean).array();
  return std::log(component.share) -
         0.5 * ((away.square() / component.variance.array()) +
                (2.0 * std::numbers::pi * component.variance.array()).log())
                   .sum();
}

// Shares of the components in each point [component][point]; returns the mean log-likelihood.
double expect(const Eigen::MatrixXd& points,
              const std::vector<MixtureComponent>& components,
              Eigen::MatrixXd& shares) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    for (std::size_t c = 0; c < components.size(); ++c) {
      shares(static_cast<Eigen::Index>(c), i) = log_density(components[c], points.col(i));
    }
    const double top = shares.col(i).maxCoeff();
    shares.col(i) = (shares.col(i).array() - top).exp();
    const double total = shares.col(i).sum();
    shares.col(i) /= total;
    sum += top + std::log(total);
  }
  return sum / static_cast<double>(points.cols());
}

void maximise(const Eigen::MatrixXd& points,
              const MixtureOptions& options,
              std::vector<MixtureComponent>& components,
              Eigen::MatrixXd& shares) {
  const auto count = static_cast<double>(points.cols());
  std::vector<MixtureComponent> next;
  for (Eigen::Index c = 0; c < shares.rows(); ++c) {
    const double weight = shares.row(c).sum();
    if (!(weight > kMinComponentShare * count)) {
      continue;
    }
    MixtureComponent one;
    one.share = weight / count;
    one.mean = points * shares.row(c).transpose() / weight;
    one.variance = (points.colwise() - one.mean).cwiseAbs2() * shares.row(c).transpose() / weight;
    one.variance.array() += options.least_variance;
    next.push_back(std::move(one));
  }
  components = std::move(next);
  shares.resize(static_cast<Eigen::Index>(components.size()), points.cols());
}

}  // namespace

GaussianMixture fit_mixture(const Eigen::MatrixXd& points, const MixtureOptions& options) {
  GaussianMixture mixture;
  if (points.cols() == 0) {
    return mixture;
  }
  // The first shares assign each point to the nearest start.
  const Eigen::MatrixXd centres = starts(points, options);
  Eigen::MatrixXd shares = Eigen::MatrixXd::Zero(centres.cols(), points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    Eigen::Index nearest = 0;
    (centres.colwise() - points.col(i)).colwise().squaredNorm().minCoeff(&nearest);
    shares(nearest, i) = 1.0;
  }
  double before = -std::numeric_limits<double>::infinity();
  for (std::size_t round = 0; round < options.most_rounds; ++round) {
    maximise(points, options, mixture.components, shares);
    mixture.mean_log_likelihood = expect(points, mixture.components, shares);
    if (mixture.mean_log_likelihood - before < options.least_gain) {
      break;
    }
    before = mixture.mean_log_likelihood;
  }
  return mixture;
}

}  // namespace rayloc
