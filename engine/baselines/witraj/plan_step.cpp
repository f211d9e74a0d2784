#include "engine/baselines/witraj/plan_step.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace rayloc {
namespace {

constexpr double kMinDeterminant = 0.05;  // of the normal equations, 1 for good geometry, chosen
constexpr double kRidge = 0.1;            // added to their diagonal if that is smaller, chosen
constexpr double kMinAntennaDistance = 0.05;  // [m], chosen: a person cannot be inside an antenna

Eigen::Vector2d away_from(const Vec3d& from, double x, double y) {
  const Eigen::Vector2d off(x - from.x, y - from.y);
  return off / std::max(kMinAntennaDistance, off.norm());
}

struct Solved {
  Eigen::Vector2d step;
  Eigen::Matrix2d by_rate;
};

Solved solve(const Vec3d& transmitter,
             std::span<const PathRateAt> rates,
             double x,
             double y,
             double seconds) {
  Eigen::MatrixX2d a(static_cast<Eigen::Index>(rates.size()), 2);
  Eigen::VectorXd b(a.rows());
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const PathRateAt& one = rates[static_cast<std::size_t>(i)];
    a.row(i) = (away_from(transmitter, x, y) + away_from(one.access_point, x, y)).transpose();
    b(i) = one.rate * seconds;
  }
  Eigen::Matrix2d normal = a.transpose() * a;
  if (normal.determinant() < kMinDeterminant) {
    normal += kRidge * Eigen::Matrix2d::Identity();
  }
  const Eigen::Matrix2d inverse = normal.inverse();
  return {inverse * a.transpose() * b,
          inverse * a.transpose() * a * inverse.transpose() * seconds * seconds};
}

}  // namespace

PlanStep plan_step(const Vec3d& transmitter,
                   std::span<const PathRateAt> rates,
                   const Vec3d& place,
                   double seconds) {
  const Eigen::Vector2d half = 0.5 * solve(transmitter, rates, place.x, place.y, seconds).step;
  const Solved whole = solve(transmitter, rates, place.x + half.x(), place.y + half.y(), seconds);
  return {whole.step.x(),
          whole.step.y(),
          {whole.by_rate(0, 0), whole.by_rate(0, 1), whole.by_rate(1, 0), whole.by_rate(1, 1)}};
}

}  // namespace rayloc
