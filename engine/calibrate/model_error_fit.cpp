#include "engine/calibrate/model_error_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>

#include <ceres/ceres.h>
#include <Eigen/Eigenvalues>

namespace rayloc {
namespace {

// One of the parameters. A scale is represented by its log2 above a floor, below which it is
// neither measurable nor useful: no plan and survey is better than half a millimetre, and the more
// the noise of a weak burst exceeds the model's, the less a map can measure it (burst_noise.h).
struct ModelErrorUnknown {
  Fitted<double> FittedModelError::*value;
  bool is_scale;
  double width;  // standard deviation of the prior, octaves if it is a scale
  double floor;
};
// Priors are about assumed_model_error(); their widths and the floors are chosen.
constexpr std::array<ModelErrorUnknown, 5> kUnknowns = {{
    {&FittedModelError::plan_tolerance, true, 3.0, 0.5e-3},
    {&FittedModelError::diffuse, true, 3.0, 1e-3},
    {&FittedModelError::diffuse_exponent, false, 1.0, 0.0},
    {&FittedModelError::diffuse_decay, true, 1.0, 0.0},
    {&FittedModelError::noise, true, 3.0, 1.25e-4},
}};
constexpr auto kCount = static_cast<int>(kUnknowns.size());  // a count, of kUnknowns
// Step of differences: the likelihood is a sum in single precision, and decays are tabulated in
// steps of a quarter.
constexpr double kSlopeStep = 0.125;
constexpr double kCurvatureStep =
    0.5;                             // as kSlopeStep; chosen: second differences need a wider one
constexpr double kConverged = 1e-6;  // of the cost, a hundredth of a unit in 10 000
constexpr int kMaxIterations = 40;   // a count, chosen: bounds the time of the fit
// For a scale, relative to its assumed value: log_evidence is not called beyond it.
constexpr double kMaxOctaves = 12.0;

using Point = Eigen::Matrix<double, kCount, 1>;

double coordinate_of(const ModelErrorUnknown& unknown, double value) {
  return unknown.is_scale ? std::log2(std::max(value - unknown.floor, 1e-12)) : value;
}

double value_at(const ModelErrorUnknown& unknown, double coordinate) {
  return unknown.is_scale ? unknown.floor + std::exp2(coordinate) : coordinate;
}

Point point_of(const FittedModelError& fit, double Fitted<double>::*what) {
  Point point;
  for (int i = 0; i < kCount; ++i) {
    const ModelErrorUnknown& unknown = kUnknowns[static_cast<std::size_t>(i)];
    point(i) = coordinate_of(unknown, fit.*unknown.value.*what);
  }
  return point;
}

FittedModelError fit_at(const Point& point, const Point& sigma) {
  FittedModelError fit = assumed_model_error();
  for (int i = 0; i < kCount; ++i) {
    const ModelErrorUnknown& unknown = kUnknowns[static_cast<std::size_t>(i)];
    Fitted<double>& found = fit.*unknown.value;
    found.value = value_at(unknown, point(i));
    found.sigma =
        sigma(i) * (unknown.is_scale ? std::numbers::ln2 * (found.value - unknown.floor) : 1.0);
  }
  return fit;
}

// Negative logarithm of the posterior.
class Cost final : public ceres::FirstOrderFunction {
 public:
  explicit Cost(const std::function<double(const ModelError&)>& log_evidence)
      : log_evidence_(log_evidence),
        prior_(point_of(assumed_model_error(), &Fitted<double>::prior)) {}

  double at(const Point& point) const {
    Point within = point;
    double prior = 0.0;
    for (int i = 0; i < kCount; ++i) {
      const double off = (point(i) - prior_(i)) / kUnknowns[static_cast<std::size_t>(i)].width;
      prior += 0.5 * off * off;
      within(i) = std::clamp(point(i), prior_(i) - kMaxOctaves, prior_(i) + kMaxOctaves);
    }
    return prior - log_evidence_(fit_at(within, Point::Zero()).value());
  }

  bool Evaluate(const double* coordinates, double* cost, double* gradient) const override {
    const Point point = Eigen::Map<const Point>(coordinates);
    *cost = at(point);
    for (int i = 0; gradient != nullptr && i < kCount; ++i) {
      const Point step = kSlopeStep * Point::Unit(i);
      gradient[i] = (at(point + step) - at(point - step)) / (2.0 * kSlopeStep);
    }
    return std::isfinite(*cost);
  }
  int NumParameters() const override { return kCount; }

  // Standard deviations of the Gaussian about a minimum. Where the evidence has the wrong curvature
  // it contains no information, and the prior remains.
  Point sigma(const Point& point) const {
    Point step;  // the width of the prior
    for (int i = 0; i < kCount; ++i) {
      step(i) = kUnknowns[static_cast<std::size_t>(i)].width;
    }
    const double here = at(point);
    Eigen::Matrix<double, kCount, kCount> curvature;
    for (int i = 0; i < kCount; ++i) {
      const Point a = kCurvatureStep * Point::Unit(i);
      curvature(i, i) = at(point + a) + at(point - a) - 2.0 * here;
      for (int j = 0; j < i; ++j) {
        const Point b = kCurvatureStep * Point::Unit(j);
        curvature(i, j) = curvature(j, i) =
            0.25 * (at(point + a + b) + at(point - a - b) - at(point + a - b) - at(point - a + b));
      }
    }
    curvature /= kCurvatureStep * kCurvatureStep;
    const Eigen::SelfAdjointEigenSolver<decltype(curvature)> eigen(step.asDiagonal() * curvature *
                                                                   step.asDiagonal());
    const Point variance = eigen.eigenvalues().cwiseMax(1.0).cwiseInverse();
    return (eigen.eigenvectors().cwiseAbs2() * variance).cwiseSqrt().cwiseProduct(step);
  }

 private:
  const std::function<double(const ModelError&)>& log_evidence_;
  Point prior_;
};

}  // namespace

FittedModelError assumed_model_error() {
  const ModelError assumed;
  const auto at = [](double value) { return Fitted<double>{value, value, 0.0}; };
  return {at(assumed.plan_tolerance),
          at(assumed.diffuse),
          at(assumed.diffuse_exponent),
          at(assumed.diffuse_decay),
          at(assumed.noise)};
}

FittedModelError fit_model_error(const std::function<double(const ModelError&)>& log_evidence,
                                 const FittedModelError& start) {
  auto owned = std::make_unique<Cost>(log_evidence);
  const Cost& cost = *owned;
  const ceres::GradientProblem problem(owned.release());  // takes ownership
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = ceres::BFGS;
  options.max_num_iterations = kMaxIterations;
  options.function_tolerance = kConverged;
  options.logging_type = ceres::SILENT;
  ceres::GradientProblemSolver::Summary summary;
  Point point = point_of(start, &Fitted<double>::value);
  ceres::Solve(options, problem, point.data(), &summary);
  return fit_at(point, cost.sigma(point));
}

}  // namespace rayloc
